#include "export/mcap/foxglove_layout.h"

#include "export/csv/json.h"

namespace quadsonde::product {
namespace {

Json path(const std::string& value) {
  return {{"value", value}, {"enabled", true}, {"timestampMethod", "receiveTime"}};
}

Json plot(const std::string& title, const Json& paths) {
  return {{"title", title},          {"paths", paths},          {"showXAxisLabels", true},
          {"showYAxisLabels", true}, {"showLegend", true},      {"legendDisplay", "floating"},
          {"isSynced", true},        {"xAxisVal", "timestamp"}, {"sidebarDimension", 240}};
}

/// Values of all bins against their heights; each leg is a topic with one message.
Json plot_over_height(const profiles::WindProfile& profile, const std::string& title, const std::string& field) {
  Json paths = Json::array();
  std::string first;
  for (const auto& leg : profile.legs) {
    const auto bins = "/quadsonde/profile/" + std::string(profiles::name(leg.name)) + ".bins[:].";
    if (first.empty()) first = bins;
    paths.push_back(path(bins + field));
  }
  // A plot has one x for all its lines: the bins' edges, which are the same for every leg, where mean heights are not.
  auto panel = plot(title, paths);
  panel["xAxisVal"] = "currentCustom";
  panel["xAxisPath"] = {{"value", first + "bin_bottom_m"}, {"enabled", true}};
  panel["isSynced"] = false;
  return panel;
}

Json split(const char* direction, Json first, Json second) {
  return {
      {"direction", direction}, {"first", std::move(first)}, {"second", std::move(second)}, {"splitPercentage", 50}};
}

}  // namespace

std::string foxglove_layout(const profiles::WindProfile* profile) {
  Json panels = {{"map!track", {{"followTopic", "/foxglove/location"}, {"layer", "map"}, {"zoomLevel", 16}}},
                 {"Plot!speed", plot("Wind speed [m/s]", {path("/quadsonde/wind.wind_speed_m_s")})},
                 {"Plot!direction", plot("Wind from [deg]", {path("/quadsonde/wind.wind_from_deg")})}};
  auto left = Json("map!track");
  if (profile && !profile->legs.empty()) {
    panels["Plot!profile_speed"] = plot_over_height(*profile, "Wind speed [m/s] over height [m]", "wind_speed_m_s");
    panels["Plot!profile_direction"] = plot_over_height(*profile, "Wind from [deg] over height [m]", "wind_from_deg");
    left = split("column", "map!track", split("row", "Plot!profile_speed", "Plot!profile_direction"));
  }
  return json_text({{"configById", panels},
                    {"globalVariables", Json::object()},
                    {"userNodes", Json::object()},
                    {"playbackConfig", {{"speed", 1}}},
                    {"layout", split("row", std::move(left), split("column", "Plot!speed", "Plot!direction"))}});
}

}  // namespace quadsonde::product
