#include "commands/reconstruct/reconstruct_ranks.h"

#include <deque>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "commands/scene_input.h"
#include "medium_loader.h"
#include "plenoflame/inverse/shared_assembly.h"

namespace plenoflame::cli {
void announce_reconstruction(const ReconstructArguments& arguments, const UnknownsRequest& unknowns,
                             Communicator& ranks) {
  nlohmann::json json{{"scenes", arguments.scenes},
                      {"set", arguments.set},
                      {"cameras", arguments.cameras},
                      {"threads", arguments.threads}};
  for (const auto& row : setting_rows<UnknownsRequest>())
    json["unknowns"][std::string(row.name)] = text_of_row(row, unknowns);
  if (unknowns.fitted_block) {
    const auto& [a, b] = *unknowns.fitted_block;
    json["fitted_block"] = {a.x, a.y, a.z, b.x, b.y, b.z};
  }
  if (unknowns.fitted_axis) {
    const auto& [p, w] = *unknowns.fitted_axis;
    json["fitted_axis"] = {p.x, p.y, p.z, w.x, w.y, w.z};
  }
  const std::string text =
      kReconstructionBegins + json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  for (int rank = 1; rank < ranks.size(); ++rank) ranks.send(rank, text);
}

bool serve_reconstruction(const RankMessage& begin, Communicator& ranks, int threads,
                          const std::stop_token& stop) {
  const nlohmann::json json = nlohmann::json::parse(begin.bytes.substr(1));
  const int asked = json.at("threads").get<int>();
  Execution execution;
  execution.threads = asked > 0 ? asked : threads;
  execution.stop = stop;
  UnknownsRequest request;
  for (const auto& [name, text] : json.at("unknowns").items())
    if (text != "") set_setting(request, {}, name, text.get<std::string>());
  const auto two_points = [&](const char* name) {
    const auto numbers = json.at(name).get<std::vector<double>>();
    return std::pair{Vec3{numbers.at(0), numbers.at(1), numbers.at(2)},
                     Vec3{numbers.at(3), numbers.at(4), numbers.at(5)}};
  };
  if (json.contains("fitted_axis")) request.fitted_axis = two_points("fitted_axis");
  if (json.contains("fitted_block")) {
    const auto [lower, upper] = two_points("fitted_block");
    request.fitted_block = {lower, upper};
  }
  std::deque<CompiledScene> scenes;
  std::vector<CameraView> views;
  for (const CameraScene& view :
       read_camera_scenes(json.at("scenes").get<std::vector<std::string>>(),
                          json.at("set").get<std::vector<std::string>>(),
                          json.at("cameras").get<std::vector<std::string>>())) {
    scenes.push_back(compile(view.document, medium_loader(), execution,
                             {scenes.empty() ? nullptr : &scenes.front()}));
    views.push_back({&scenes.back(), {}});
  }
  const std::unique_ptr<Unknowns> unknowns = unknowns_of(request, scenes.front());
  return serve_assembly(views, *unknowns, ranks, execution);
}

}  // namespace plenoflame::cli
