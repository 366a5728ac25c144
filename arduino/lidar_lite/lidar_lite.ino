// A Garmin LIDAR-Lite v3 on an Arduino's I2C, its readings on USB for range_serial (protocol lidar_lite).
//
// Wiring (LIDAR-Lite v3 manual, "Standard Arduino I2C Wiring"): red to 5V, black to GND, green to SCL, blue to SDA, and
// 680 uF between 5V and GND.
//
// Lines, 115200 baud, each ended by \r\n:
//   R,<cm>,<strength>*<checksum>   a measurement, e.g. R,123,45*63; without <cm> there was no return
//   E*<checksum>                   the sensor does not answer
// <checksum>: exclusive or of the characters before the star, as two hexadecimal digits (as in NMEA 0183).
//
// Registers: LIDAR-Lite v3 manual, "Operational Information" and "Control Registers".

#include <Wire.h>

const uint8_t kAddress = 0x62;
const uint8_t kCommand = 0x00;           // register; 0x04: measure with receiver bias correction
const uint8_t kStatus = 0x01;            // register; bit 0: busy, bit 3: no peak found, the measurement is invalid
const uint8_t kStrength = 0x0e;          // register
const uint8_t kDistance = 0x8f;          // registers 0x0f and 0x10, high byte first; bit 7: the next with it
const unsigned long kMostBusy_ms = 100;  // longer: it hangs
const unsigned int kImpossible_cm = 1;   // within the lens: what it reads without a return

bool writeRegister(uint8_t address, uint8_t value) {
  Wire.beginTransmission(kAddress);
  Wire.write(address);
  Wire.write(value);
  return Wire.endTransmission() == 0;
}

bool readRegisters(uint8_t address, uint8_t* values, uint8_t count) {
  Wire.beginTransmission(kAddress);
  Wire.write(address);
  if (Wire.endTransmission() != 0 || Wire.requestFrom(kAddress, count) != count) return false;
  for (uint8_t i = 0; i < count; ++i) values[i] = Wire.read();
  return true;
}

// Whether a measurement was made; its status.
bool measure(uint8_t& status) {
  if (!writeRegister(kCommand, 0x04)) return false;
  const unsigned long start_ms = millis();
  do {
    if (!readRegisters(kStatus, &status, 1)) return false;
    if (!(status & 0x01)) return true;
  } while (millis() - start_ms < kMostBusy_ms);
  return false;
}

void sendLine(const char* body) {
  uint8_t checksum = 0;
  for (const char* c = body; *c != '\0'; ++c) checksum ^= static_cast<uint8_t>(*c);
  char line[32];
  snprintf(line, sizeof line, "%s*%02X\r\n", body, static_cast<unsigned int>(checksum));
  Serial.print(line);
}

void setup() {
  Serial.begin(115200);
  Wire.begin();
  Wire.setClock(400000);
#ifdef WIRE_HAS_TIMEOUT
  Wire.setWireTimeout(25000, true);  // a bus that is held low must not hang us
#endif
}

void loop() {
  uint8_t status = 0, distance[2] = {0, 0}, strength = 0;
  if (!measure(status) || !readRegisters(kDistance, distance, 2) || !readRegisters(kStrength, &strength, 1)) {
    sendLine("E");
    delay(100);
    return;
  }
  const unsigned int distance_cm = static_cast<unsigned int>(distance[0]) << 8 | distance[1];
  char body[24];
  if ((status & 0x08) || distance_cm <= kImpossible_cm) {
    snprintf(body, sizeof body, "R,,%u", static_cast<unsigned int>(strength));
  } else {
    snprintf(body, sizeof body, "R,%u,%u", distance_cm, static_cast<unsigned int>(strength));
  }
  sendLine(body);
}
