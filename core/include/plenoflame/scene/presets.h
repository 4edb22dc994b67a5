#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace plenoflame {

/// The tables that a preset may stand in: "[camera] preset = ...", "[camera.lens] preset = ..." or
/// "[[flames]] preset = ...".
enum class PresetKind { camera, flame, lens };

/// Names of the presets of a kind, sorted.
std::vector<std::string> preset_names(PresetKind kind);

/// The preset as the text of a scene-file fragment with its comments. Comments name the values that
/// the source leaves open and that were chosen.
/// @throws InputError naming the nearest preset
std::string_view preset_text(PresetKind kind, std::string_view name);

/// One sentence about it: the first comment line of its text.
std::string preset_description(PresetKind kind, std::string_view name);

}  // namespace plenoflame
