#pragma once
#include <stop_token>

#include "commands/reconstruct/reconstruct_options.h"
#include "plenoflame/base/communicator.h"

namespace plenoflame::cli {

/// First byte of the message with which rank 0 requests help with a reconstruction.
inline constexpr char kReconstructionBegins = 'v';

/// Tells the other ranks the cameras, and what is solved for.
/// @param unknowns with an axis that was fitted
void announce_reconstruction(const ReconstructArguments& arguments, const UnknownsRequest& unknowns,
                             Communicator& ranks);

/// The part of a rank above 0 in it: it draws rays and makes rows.
/// @param begin message that begins with kReconstructionBegins @param threads unless rank 0 says
/// how many @return false when it is to quit
bool serve_reconstruction(const RankMessage& begin, Communicator& ranks, int threads,
                          const std::stop_token& stop);

}  // namespace plenoflame::cli
