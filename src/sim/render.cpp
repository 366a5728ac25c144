#include "sim/render.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "sim/texture.hpp"

namespace flight_corridor::sim {
namespace {

constexpr float kSky = 1.0f;
constexpr float kHaze = 0.75f;
constexpr int kSkyId = -1;
constexpr int kLeafId = -2;  // of all leaves; their outlines are not anti-aliased: there are too many
constexpr int kTile_px = 8;
constexpr int kSubsamples = 8;       // on outlines only
constexpr float kUnhidden = 0.999f;  // of the way from the projector to a point: its own surface does not hide it

/// Where on the image a primitive can be.
struct Extent {
  cv::Rect pixels;
  double nearest_m;  // depth
};

/// A primitive as the camera meets it: everything that all rays share.
struct View {
  const Primitive* primitive;
  Eigen::Vector3f origin_O;  // the camera's
  Eigen::Matrix3f R_O_C;
  Eigen::Vector3f to_sun_O;
  Extent extent;
};

struct Sample {
  int id = kSkyId;
  float depth_m = std::numeric_limits<float>::quiet_NaN();
  float radiance = kSky;
};

/// Pixels that touch a rectangle, on the image, and one around for subsamples.
cv::Rect pixelsBetween(const Eigen::Array3d& low, const Eigen::Array3d& high, const cv::Size& size_px) {
  // Clamped before the conversion: what is nearly beside the camera projects beyond the range of int.
  const auto within = [](double value, int size) { return static_cast<int>(std::clamp(value, -1.0, size + 1.0)); };
  const cv::Point from(within(std::floor(low.x()) - 1.0, size_px.width),
                       within(std::floor(low.y()) - 1.0, size_px.height));
  const cv::Point to(within(std::ceil(high.x()) + 2.0, size_px.width),
                     within(std::ceil(high.y()) + 2.0, size_px.height));
  return cv::Rect(from, to) & cv::Rect({0, 0}, size_px);
}

/// Of a sphere before the camera, between the tangents to it.
Extent extentOfSphere(const Eigen::Vector3d& centre_C, double radius_m, const Camera& camera) {
  const auto tangents = [&](double across_m) -> Eigen::Array2d {  // as slopes, across over ahead
    const double z_m = centre_C.z();
    const double root = radius_m * std::sqrt(across_m * across_m + z_m * z_m - radius_m * radius_m);
    return (Eigen::Array2d(-root, root) + across_m * z_m) / (z_m * z_m - radius_m * radius_m);
  };
  const Eigen::Array2d u = camera.fx_px * tangents(centre_C.x()) + camera.cx_px;
  const Eigen::Array2d v = camera.fy_px * tangents(centre_C.y()) + camera.cy_px;
  return {pixelsBetween({u[0], v[0], 0.0}, {u[1], v[1], 0.0}, camera.size_px), centre_C.z() - radius_m};
}

/// Of the primitive's box, cut off just before the camera: both ends of what is left of its twelve edges.
Extent extentOf(const Primitive& primitive, const Camera& camera, const Eigen::Isometry3d& T_C_O) {
  constexpr double kNear_m = 0.01;
  const bool is_round = primitive.shape == Shape::Sphere || primitive.shape == Shape::Foliage;
  const Eigen::Vector3d centre_C = T_C_O.translation();
  if (is_round && centre_C.z() - primitive.half_m.x() > kNear_m) {
    return extentOfSphere(centre_C, primitive.half_m.x(), camera);
  }
  Eigen::Array3d low = Eigen::Array3d::Constant(kInfinity);  // u, v, depth
  Eigen::Array3d high = -low;
  const auto cornerAt = [&](int corner) -> Eigen::Vector3d {
    const Eigen::Vector3d signs((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1, (corner & 4) != 0 ? 1 : -1);
    return T_C_O * primitive.half_m.cwiseProduct(signs);
  };
  const auto cover = [&](const Eigen::Vector3d& p_C) {
    const Eigen::Array3d projected(camera.fx_px * p_C.x() / p_C.z() + camera.cx_px,
                                   camera.fy_px * p_C.y() / p_C.z() + camera.cy_px, p_C.z());
    low = low.min(projected);
    high = high.max(projected);
  };
  for (int corner = 0; corner < 8; ++corner) {
    for (const int next : {corner | 1, corner | 2, corner | 4}) {
      const Eigen::Vector3d from_C = cornerAt(corner), to_C = cornerAt(next);
      const double share = (kNear_m - from_C.z()) / (to_C.z() - from_C.z());
      if (from_C.z() >= kNear_m) cover(from_C);
      if (to_C.z() >= kNear_m) cover(to_C);
      if (0.0 < share && share < 1.0) cover(from_C + share * (to_C - from_C));
    }
  }
  const bool behind = low.z() == kInfinity;
  return {behind ? cv::Rect() : pixelsBetween(low, high, camera.size_px), low.z()};
}

/// Nearest first; also what only a mirror can show.
std::vector<View> viewsOf(const std::vector<Primitive>& primitives, const Camera& camera,
                          const Eigen::Vector3d& to_sun_W) {
  std::vector<View> views;
  for (const Primitive& primitive : primitives) {
    if (!primitive.material.camera_sees) continue;
    const Eigen::Isometry3d T_O_C = primitive.T_W_O.inverse() * camera.T_W_C;
    const Extent extent = extentOf(primitive, camera, T_O_C.inverse());
    views.push_back({&primitive, T_O_C.translation().cast<float>(), T_O_C.linear().cast<float>(),
                     (primitive.T_W_O.linear().transpose() * to_sun_W).cast<float>(), extent});
  }
  std::sort(views.begin(), views.end(),
            [](const View& a, const View& b) { return a.extent.nearest_m < b.extent.nearest_m; });
  return views;
}

/// One image under way, tile by tile: first a ray through each pixel, then more rays where neighbours differ.
class Renderer {
 public:
  Renderer(const std::vector<Primitive>& primitives, const Camera& camera, const Light& light)
      : camera_(camera),
        light_(light),
        views_(viewsOf(primitives, camera, light.to_sun_W)),
        tiles_((camera.size_px.width + kTile_px - 1) / kTile_px, (camera.size_px.height + kTile_px - 1) / kTile_px),
        candidates_(tiles_.area()),
        ids_(camera.size_px, CV_32SC1),
        rendering_{cv::Mat(camera.size_px, CV_32FC1), cv::Mat(camera.size_px, CV_32FC1)} {
    for (int id = 0; id < static_cast<int>(views_.size()); ++id) addCandidate(id);
  }

  Rendering run() {
    forEachPixel([this](const std::vector<int>& candidates, int u, int v) { castThroughCentre(candidates, u, v); });
    forEachPixel([this](const std::vector<int>& candidates, int u, int v) {
      if (onOutline(u, v)) rendering_.radiance.at<float>(v, u) = averageOver(candidates, u, v);
    });
    return rendering_;
  }

 private:
  void addCandidate(int id) {
    const cv::Rect& box = views_[id].extent.pixels;
    if (box.empty()) return;
    for (int y = box.y / kTile_px; y <= (box.br().y - 1) / kTile_px; ++y) {
      for (int x = box.x / kTile_px; x <= (box.br().x - 1) / kTile_px; ++x) {
        candidates_[y * tiles_.width + x].push_back(id);
      }
    }
  }

  template <typename Visit>
  void forEachPixel(const Visit& visit) {
    cv::parallel_for_(cv::Range(0, tiles_.area()), [&](const cv::Range& range) {
      for (int tile = range.start; tile < range.end; ++tile) {
        const cv::Rect pixels =
            cv::Rect(tile % tiles_.width * kTile_px, tile / tiles_.width * kTile_px, kTile_px, kTile_px) &
            cv::Rect({0, 0}, camera_.size_px);
        for (int v = pixels.y; v < pixels.br().y; ++v) {
          for (int u = pixels.x; u < pixels.br().x; ++u) visit(candidates_[tile], u, v);
        }
      }
    });
  }

  void castThroughCentre(const std::vector<int>& candidates, int u, int v) {
    const Sample sample = cast(candidates, static_cast<float>(u), static_cast<float>(v));
    ids_.at<int>(v, u) = sample.id;
    rendering_.depth_m.at<float>(v, u) = sample.depth_m;
    rendering_.radiance.at<float>(v, u) = sample.radiance;
  }

  bool onOutline(int u, int v) const {
    const int id = ids_.at<int>(v, u);
    const auto differs = [&](int x, int y) {
      if (x < 0 || ids_.cols <= x || y < 0 || ids_.rows <= y) return false;
      const int other = ids_.at<int>(y, x);
      return other != id && other != kLeafId;
    };
    return id != kLeafId && (differs(u - 1, v) || differs(u + 1, v) || differs(u, v - 1) || differs(u, v + 1));
  }

  /// Mean over the pixel's square: each sample has its own row and its own column of an 8x8 grid.
  float averageOver(const std::vector<int>& candidates, int u, int v) const {
    float sum = 0.0f;
    for (int i = 0; i < kSubsamples; ++i) {
      const float du = (static_cast<float>(3 * i % kSubsamples) + 0.5f) / kSubsamples - 0.5f;
      const float dv = (static_cast<float>(i) + 0.5f) / kSubsamples - 0.5f;
      sum += cast(candidates, static_cast<float>(u) + du, static_cast<float>(v) + dv).radiance;
    }
    return sum / kSubsamples;
  }

  Sample cast(const std::vector<int>& candidates, float u, float v) const {
    const Eigen::Vector3f direction_C((u - static_cast<float>(camera_.cx_px)) / static_cast<float>(camera_.fx_px),
                                      (v - static_cast<float>(camera_.cy_px)) / static_cast<float>(camera_.fy_px), 1);
    const cv::Point pixel(cvRound(u), cvRound(v));
    int nearest_id = kSkyId;
    SurfacePoint nearest{std::numeric_limits<float>::infinity(), {}};
    for (const int id : candidates) {
      const Extent& extent = views_[id].extent;
      if (extent.nearest_m >= nearest.t) break;
      if (!extent.pixels.contains(pixel)) continue;
      const auto hit = intersect(*views_[id].primitive, views_[id].origin_O, views_[id].R_O_C * direction_C);
      if (!hit || hit->t >= nearest.t) continue;
      nearest = *hit;
      nearest_id = id;
    }
    return nearest_id == kSkyId ? sky(direction_C) : look(nearest_id, nearest, direction_C);
  }

  Sample sky(const Eigen::Vector3f& direction_C) const {
    Sample sample;
    if (light_.has_clouds) sample.radiance = cloudySky(camera_.T_W_C.linear().cast<float>() * direction_C);
    return sample;
  }

  Sample look(int id, const SurfacePoint& surface, const Eigen::Vector3f& direction_C) const {
    const View& view = views_[id];
    const Eigen::Vector3f direction_O = view.R_O_C * direction_C;
    const Eigen::Vector3f point_O = view.origin_O + surface.t * direction_O;
    Sample sample{id, surface.t, shade(view, point_O, surface.normal_O, direction_O, surface.t)};
    if (view.primitive->shape == Shape::Foliage) sample.id = kLeafId;
    const float mirror = view.primitive->material.mirror;
    if (mirror == 0.0f) return sample;
    const Sample image = mirrored(view, point_O, surface, direction_O);
    sample.id += (image.id + 2) * static_cast<int>(views_.size());  // outlines in the mirror are outlines
    sample.radiance += mirror * (image.radiance - sample.radiance);
    return sample;
  }

  /// What a mirror shows at a point of its own frame: the ray goes on from there. Mirrors in a mirror look dull.
  Sample mirrored(const View& mirror, const Eigen::Vector3f& point_O, const SurfacePoint& surface,
                  const Eigen::Vector3f& direction_O) const {
    const Eigen::Vector3f origin_C = mirror.R_O_C.transpose() * (point_O - mirror.origin_O);
    const Eigen::Vector3f direction_C =
        mirror.R_O_C.transpose() * (direction_O - 2.0f * surface.normal_O.dot(direction_O) * surface.normal_O);
    Sample nearest;
    nearest.depth_m = std::numeric_limits<float>::infinity();  // beyond the mirror
    for (const View& view : views_) {
      if (&view == &mirror) continue;
      const Eigen::Vector3f origin_V = view.origin_O + view.R_O_C * origin_C, direction_V = view.R_O_C * direction_C;
      const auto hit = intersect(*view.primitive, origin_V, direction_V);
      if (!hit || hit->t >= nearest.depth_m) continue;
      nearest = {static_cast<int>(&view - views_.data()), hit->t,
                 shade(view, origin_V + hit->t * direction_V, hit->normal_O, direction_V, surface.t + hit->t)};
    }
    return nearest;
  }

  /// Radiance of a matt surface. @param path_m from the camera, along z of C and of its mirror image.
  float shade(const View& view, const Eigen::Vector3f& point_O, const Eigen::Vector3f& normal_O,
              const Eigen::Vector3f& direction_O, float path_m) const {
    const float facing = std::max(-normal_O.dot(direction_O) / direction_O.norm(), 0.05f);
    // Seen aslant the footprint is stretched in one direction only: the geometric mean of both edges.
    const float footprint_m = path_m / static_cast<float>(camera_.fx_px) / std::sqrt(facing);
    float sun = std::max(normal_O.dot(view.to_sun_O), 0.0f);
    if (light_.shadows && sun > 0.0f) sun *= light_.shadows->lit(view.primitive->T_W_O.cast<float>() * point_O);
    float light = light_.ambient + (1.0f - light_.ambient) * sun;
    if (light_.dots) light += dotLight(view, point_O, normal_O);
    const float radiance = light * reflectance(view.primitive->material, point_O, footprint_m);
    if (light_.haze_m == kInfinity) return radiance;
    return kHaze + (radiance - kHaze) * std::exp(-path_m / static_cast<float>(light_.haze_m));
  }

  /// Of the projector, unless something stands between.
  float dotLight(const View& view, const Eigen::Vector3f& point_O, const Eigen::Vector3f& normal_O) const {
    const Eigen::Isometry3f T_W_O = view.primitive->T_W_O.cast<float>();
    const Eigen::Vector3f point_W = T_W_O * point_O;
    const float light =
        light_.dots->light(point_W, T_W_O.linear() * normal_O, 1.0f / static_cast<float>(camera_.fx_px));
    if (light == 0.0f) return light;
    const Eigen::Vector3f origin_W = light_.dots->T_P_W.inverse().translation().cast<float>();
    const auto hides = [&](const View& other) {
      const Eigen::Isometry3f T_V_W = other.primitive->T_W_O.inverse().cast<float>();
      const auto hit = intersect(*other.primitive, T_V_W * origin_W, T_V_W.linear() * (point_W - origin_W));
      return hit && hit->t < kUnhidden;
    };
    return std::any_of(views_.begin(), views_.end(), hides) ? 0.0f : light;
  }

  const Camera& camera_;
  const Light& light_;
  std::vector<View> views_;
  cv::Size tiles_;
  std::vector<std::vector<int>> candidates_;  // per tile, nearest first
  cv::Mat ids_;                               // CV_32SC1
  Rendering rendering_;
};

}  // namespace

Rendering render(const std::vector<Primitive>& primitives, const Camera& camera, const Light& light) {
  return Renderer(primitives, camera, light).run();
}

}  // namespace flight_corridor::sim
