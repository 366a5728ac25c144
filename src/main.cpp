#include "ros/programs.hpp"
#include "tools/programs.hpp"

// Programs are functions of the libraries: nearly all of the time that each would compile is that of the same headers.
int main(int argc, char** argv) { return FLIGHT_CORRIDOR_PROGRAM(argc, argv); }
