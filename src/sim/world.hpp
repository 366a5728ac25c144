#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <vector>

#include "flight_corridor/types.hpp"

namespace flight_corridor::sim {

/// The LiDAR's return from a surface.
enum class LidarReturn : std::uint8_t { Surface, PassesThrough, Absorbed };

/// How a surface looks.
struct Material {
  float grey = 0.45f;             ///< Mean reflectance [0..1].
  float contrast = 0.35f;         ///< Amplitude of the noise texture relative to grey; 0 = blank.
  float coarsest_m = 0.64f;       ///< Wavelength of the coarsest octave of the noise.
  float finest_m = 0.008f;        ///< No octave is finer: a wall has about the same grain everywhere.
  float stretch = 1.0f;           ///< Of the noise along z of the object: 4 = grain four times as long as wide.
  std::uint32_t seed = 0;         ///< Of the noise.
  float checker_period_m = 0.0f;  ///< Two fields of a chequered pattern along x, y and z of the object; 0 = none.
  float mirror = 0.0f;      ///< Share of the camera's light that is a mirror image; the rest is the surface's own.
  bool camera_sees = true;  ///< false: glass, to the camera.
  LidarReturn lidar_return = LidarReturn::Surface;
};

/// Foliage is a sphere full of leaves: rays pass between them; for the truth it is solid.
enum class Shape : std::uint8_t { Box, Cylinder, Sphere, Foliage };

/// A convex solid, centred on its object frame O. A cylinder's axis is z of O.
struct Primitive {
  Shape shape = Shape::Box;
  Eigen::Isometry3d T_W_O = Eigen::Isometry3d::Identity();  ///< At time 0.
  Eigen::Vector3d half_m{
      0.5, 0.5, 0.5};  ///< Half extents; the radius is x for cylinders (and y) and all round shapes (and y, z).
  Material material;
  Eigen::Vector3d velocity_W{0, 0, 0};  ///< [m/s]
  double visible_from_s = -kInfinity;
  double visible_until_s = kInfinity;
};

/// @param size_m full extents.
Primitive makeBox(const Eigen::Vector3d& centre_W, const Eigen::Vector3d& size_m, const Material& material);
/// Cylinder between the centres of its two end faces.
Primitive makeCylinder(const Eigen::Vector3d& from_W, const Eigen::Vector3d& to_W, double radius_m,
                       const Material& material);
Primitive makeSphere(const Eigen::Vector3d& centre_W, double radius_m, const Material& material);
Primitive makeFoliage(const Eigen::Vector3d& centre_W, double radius_m, const Material& material);

/// The primitives that exist at a time, at their places then.
std::vector<Primitive> visibleAt(const std::vector<Primitive>& world, double time_s);

/// A primitive's surface as a ray met it, in O.
struct SurfacePoint {
  float t;                   ///< Ray parameter: point = origin + t * direction.
  Eigen::Vector3f normal_O;  ///< Unit, towards where the ray comes from.
};

/// First point where a ray enters a primitive; nullopt when it misses, starts inside or meets it at t <= 0. Of foliage
/// the first leaf, also from inside.
std::optional<SurfacePoint> intersect(const Primitive& primitive, const Eigen::Vector3f& origin_O,
                                      const Eigen::Vector3f& direction_O);

}  // namespace flight_corridor::sim
