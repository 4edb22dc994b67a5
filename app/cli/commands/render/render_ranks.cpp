#include "commands/render/render_ranks.h"

#include <cstddef>
#include <exception>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#ifdef PLENOFLAME_HAS_VOLUMES
#include "commands/reconstruct/reconstruct_ranks.h"
#endif
#include "commands/series/sweep_ranks.h"
#include "medium_loader.h"
#include "plenoflame/base/execution.h"
#include "plenoflame/render/ranks.h"
#include "plenoflame/scene/scene_file.h"
#include "plenoflame/scene/validate.h"

namespace plenoflame::cli {
namespace {

constexpr char kScene = 'S';  ///< from rank 0: the scene as JSON

}  // namespace

void announce_scene(const Scene& scene, const SceneUse& use, bool white, int threads,
                    Communicator& ranks) {
  const nlohmann::json json{{"scene", write_scene(scene)},
                            {"file", std::filesystem::absolute(scene.file).string()},
                            {"view", use.view},
                            {"begin", use.begin},
                            {"white", white},
                            {"threads", threads}};
  const std::string text =
      kScene + json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  for (int rank = 1; rank < ranks.size(); ++rank) ranks.send(rank, text);
}

void serve_renderings(Communicator& ranks, int threads, const std::stop_token& stop) {
  Execution execution;
  execution.stop = stop;
  CompiledScenes scenes;
  const CompiledScene* compiled = nullptr;
  bool white = false;
  for (;;) {
    const RankMessage message = wait_for_message(ranks);
    const char what = message.bytes.front();
    if (what == rank_message::kQuit) return;
    try {
      if (what == kScene) {
        const auto json = nlohmann::json::parse(message.bytes.substr(1));
        const int asked = json.at("threads").get<int>();
        execution.threads = asked > 0 ? asked : threads;
        SceneDocument document =
            parse_scene(json.at("scene").get<std::string>(), json.at("file").get<std::string>());
        static_cast<void>(validate(document));
        if (white) scenes.clear();  // its light was not the scene's
        white = json.at("white").get<bool>();
        const SceneUse use{json.at("view").get<std::size_t>(), json.at("begin").get<double>()};
        compiled = nullptr;
        compiled = &scenes.of(document.scene, use, [&](const EarlierScenes& earlier) {
          CompiledScene made =
              compile(document.scene, medium_loader(), execution, document.positions, earlier);
          if (white) fill_with_light(made);
          return made;
        });
      }
      if (what == kSweepBegins) serve_sweep(message, ranks, threads, stop);
#ifdef PLENOFLAME_HAS_VOLUMES
      if (what == kReconstructionBegins && !serve_reconstruction(message, ranks, threads, stop))
        return;
#endif
      if (what == rank_message::kRender && compiled &&
          !serve_render(*compiled, message, ranks, execution))
        return;
    } catch (const std::exception& error) {
      compiled = nullptr;
      ranks.send(0, rank_message::kFailed + std::string(error.what()));
    }
  }
}

}  // namespace plenoflame::cli
