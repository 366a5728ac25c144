#pragma once

#include "sim/random.hpp"
#include "sim/scenes.hpp"

// The parts of scenes. At most one argument of a call draws from Random: C++ leaves the order of arguments open, a seed
// must not.

namespace flight_corridor::sim {

// The flight starts above W's origin, flies along +x, 1.5 m above ground; the camera is 0.10 m ahead of the body.
constexpr double kHeight_m = 1.5;
constexpr double kAhead_m = 0.10;
// The corridor about the camera's axis.
constexpr double kHalfWidth_m = 0.6;
constexpr double kHalfHeight_m = 0.2;

Material textured(Random& random, double grey, double contrast, double coarsest_m);
Material masonry(Random& random);
Material bark(Random& random);
/// Without texture.
Material plain(double grey);

/// Wall across the flight, its near face at x.
Primitive wallAcross(double x_m, double y_right_m, double y_left_m, double height_m, const Material& material);
/// A wall that fills the view, to stand beyond the corridor.
Primitive backdrop(double x_m, const Material& material);
Primitive uprightPole(double x_m, double y_m, double radius_m, double height_m, const Material& material);
/// Turned about the vertical through its middle, left positive.
Primitive turned(Primitive primitive, double angle_rad);

void addGround(double coarsest_m, Scene& scene, Random& random);
/// Hills or houses, 30 to 45 m away all around.
void addSurroundings(Scene& scene, Random& random);

/// Lateral place of the left camera's axis in W.
double middle(const Scene& scene);
/// Hardly any sway and wobble: at the corridor's far end it moves by less than 0.02 m.
void flySteadily(Scene& scene);
/// Flies until the camera stands at x.
void flyUntil(Scene& scene, double x_m, double speed_m_s);
/// Plans a flight at 0.7 to 4 m/s towards an obstacle: at first it is beyond the corridor, at last stop_m before the
/// camera.
/// @return x of the obstacle's near side.
double approach(Scene& scene, Random& random, double stop_m = 1.5);

/// Flies at a textured wall or, for others, at a wall of some material.
void addWall(Scene& scene, Random& random);
void addWallOf(const Material& material, Scene& scene, Random& random);

}  // namespace flight_corridor::sim
