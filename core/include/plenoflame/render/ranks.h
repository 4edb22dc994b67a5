#pragma once
#include <stop_token>

#include "plenoflame/base/communicator.h"
#include "plenoflame/base/execution.h"
#include "plenoflame/scene/compile.h"

namespace plenoflame {

/// First bytes of the messages between render() and the other ranks (RenderSettings::ranks).
/// Messages for other purposes begin with other letters.
namespace rank_message {
inline constexpr char kRender = 'R';  ///< from rank 0: a rendering begins, serve_render()
inline constexpr char kQuit = 'Q';    ///< from rank 0: no more messages follow
inline constexpr char kFailed = 'F';  ///< to rank 0: an error message; ends the rendering
}  // namespace rank_message

/// The work of a rank above 0 in a rendering: it traces the tiles that rank 0 hands out, until the
/// rendering ends.
/// @param scene compiled from the same scene as on rank 0
/// @param begin message that begins with kRender
/// @return false when kQuit came
bool serve_render(const CompiledScene& scene, const RankMessage& begin, Communicator& ranks,
                  const Execution& execution);

/// Waits for the next message: some microseconds at first, then longer, without using processor
/// time. @throws Cancelled
RankMessage wait_for_message(Communicator& ranks, const std::stop_token& stop = {});

}  // namespace plenoflame
