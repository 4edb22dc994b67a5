#pragma once

namespace plenoflame {

/// Colours for values. All but grey and diverging rise evenly in lightness, so that they mean the
/// same to colour-blind people and in print.
enum class ColourMap { grey, viridis, cividis, inferno, diverging };

struct Rgb {
  unsigned char red = 0, green = 0, blue = 0;
};

/// @param t from 0 to 1; beyond it the ends
Rgb colour(ColourMap map, double t);
/// The same for a flame: without the dark part of inferno, which would look like a hole in it
/// before a dark background.
Rgb flame_colour(ColourMap map, double t);

}  // namespace plenoflame
