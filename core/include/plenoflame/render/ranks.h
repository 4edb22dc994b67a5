#pragma once
#include "plenoflame/base/communicator.h"
#include "plenoflame/base/execution.h"
#include "plenoflame/scene/compile.h"

namespace plenoflame {

struct CompiledCamera;

/// First bytes of the messages that render() exchanges with the other ranks
/// (RenderSettings::ranks). Messages of other uses begin with other letters.
namespace rank_message {
inline constexpr char kRender = 'R';  ///< from rank 0: a rendering begins, serve_render()
inline constexpr char kQuit = 'Q';    ///< from rank 0: there will be no more
inline constexpr char kFailed = 'F';  ///< to rank 0: what is wrong, as a text; ends the rendering
}  // namespace rank_message

/// The work of a rank above 0 in a rendering: it traces the tiles that rank 0 hands out, until that
/// is at its end.
/// @param scene compiled from the same scene as that of rank 0
/// @param camera of a rendering by a compiled camera; nullptr: there is none
/// @param begin message that begins with kRender
/// @return false when kQuit came
bool serve_render(const CompiledScene& scene, const CompiledCamera* camera,
                  const RankMessage& begin, Communicator& ranks, const Execution& execution);

/// Waits for the next message, without taking up a processor.
RankMessage wait_for_message(Communicator& ranks);

}  // namespace plenoflame
