#include "ros/params.hpp"

#include "ros/image_scale.hpp"
#include "ros/transforms.hpp"

namespace flight_corridor_ros {

namespace {

using flight_corridor::above;
using flight_corridor::from;
using flight_corridor::ParameterTable;
using flight_corridor::Rule;
using flight_corridor::Tier;

ParameterTable tableOf(RosConfig& c) {
  const bool is_frame = c.gravity_frame.find_first_not_of('/') != std::string::npos;
  return {"ros",
          "The node",
          {{"approximate_sync", &c.approximate_sync, Rule(),
            "pair images whose stamps differ; false: equal stamps only", Tier::Configure},
           {"sync_slop_s", &c.sync_slop_s, from(0).upTo(10),
            "[s] largest difference within a pair when approximate_sync", Tier::Configure},
           {"sync_queue", &c.sync_queue, from(1), "images and CameraInfos that wait for their partners, per topic"},
           {"gravity_frame", &c.gravity_frame, Rule().where(is_frame, "a frame's name"),
            "fixed frame of tf, z up: says where up is, for the imu's acceleration, the level corridor and the scan",
            Tier::Configure},
           {"watchdog_s", &c.watchdog_s, above(0).inFlight(0.1, 5.0),
            "[s] after this long without a verdict, UNKNOWN (NO_DATA) is published", Tier::Tune},
           {"tf_timeout_s", &c.tf_timeout_s, from(0).upTo(10), "[s] wait for a pose at an image's stamp", Tier::Tune},
           {"image_transport", &c.image_transport, Rule().where(!c.image_transport.empty(), "a transport's name"),
            "transport of the incoming images: raw, compressed, ...", Tier::Configure},
           {"scale", &c.scale, Rule().where(isImageScale(c.scale), "1, 0.5, 0.25 or 0.125"),
            "of the images that are processed; parameters in pixels above refer to the scaled images", Tier::Tune}}};
}

}  // namespace

std::vector<ParameterTable> tablesOf(NodeConfig& config) {
  std::vector<ParameterTable> tables = flight_corridor::tablesOf(config.core);
  tables.front().rows.push_back({"mask", &config.mask, Rule(),
                                 "image file of the left image's size, black where the UAV's own parts cover the view: "
                                 "there is neither obstacle nor clear view; \"\": nothing of it is in view",
                                 Tier::Configure});
  tables.push_back(tableOf(config.ros));
  return tables;
}

NodeConfig makeConfig(const Values& values) {
  NodeConfig config;
  flight_corridor::throwIfBroken(flight_corridor::assign(values, [&config] { return parametersOf(tablesOf(config)); }));
  for (std::string* frame : {&config.core.map.frame_id, &config.core.corridor.frame_id, &config.ros.gravity_frame}) {
    *frame = withoutSlash(*frame);  // as tf2 names it
  }
  return config;
}

Values toValues(const NodeConfig& config) {
  NodeConfig copy = config;
  return valuesOf(parametersOf(tablesOf(copy)));
}

}  // namespace flight_corridor_ros
