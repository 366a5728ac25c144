#pragma once

#include <string_view>

#include "serial/measurement.hpp"

namespace flight_corridor::serial {

/// Reads a line of a LightWare LiDAR: metres with two decimals, as
///   98.67        the answer to the legacy command d
///   ?LD 98.67    the answer to ?LD of an SF11
///   ld,0:23.67   the answer to ?LD of a LW20 or SF20, and its stream
/// A unit, " m", may follow. Lines have no checksum and no strength. A lost signal is -1, -1.0 or -1.00 (LW20, SF20),
/// or a distance beyond the sensor's range (SF11: 130.00), which the limits turn into +inf; any other number below 0 is
/// the code of an error. Source: LightWare SF11/C product manual, menu item n and "Command set"; LW20/SF20 product
/// manual, appendix C.
Parsed parseLightware(std::string_view line);

}  // namespace flight_corridor::serial
