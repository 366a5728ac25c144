#pragma once

namespace flight_corridor::programs {

// The tools, named as the programs, each from its command line to its exit code: runTool().
int characterize_noise(int argc, char** argv);
int evaluate(int argc, char** argv);
int fly(int argc, char** argv);
int import_folder(int argc, char** argv);
int replay(int argc, char** argv);
int simulate(int argc, char** argv);

}  // namespace flight_corridor::programs
