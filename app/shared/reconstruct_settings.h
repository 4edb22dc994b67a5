#pragma once
#include "inverse_settings.h"
#include "plenoflame/volumes/reconstruct_request.h"

namespace plenoflame {

template <>
std::span<const SettingRow<ReconstructRequest>> setting_rows();

}  // namespace plenoflame
