#pragma once
#include "plenoflame/film/film.h"
#include "plenoflame/image/light_field.h"

namespace plenoflame {

/// The entry of LightField::texts that holds the samples per replicate of the film's tiles, where
/// they differ: "COUNTxSAMPLES" of runs of neighbouring tiles, separated by blanks.
inline constexpr const char* kTileSamples = "render.tile_samples";

/// Entries of LightField::texts. The first is set for a part of a picture ("2/4", base/part.h). The
/// second is set for a merged picture (render/merge.h) that no run can continue.
inline constexpr const char* kPartOfPicture = "render.part";
inline constexpr const char* kMergedPicture = "render.merged";

/// That entry of kTileSamples. @return empty when all tiles have the same
std::string tile_samples_text(const Film& film);

/// Samples per replicate of every tile of a picture. @param tiles how many it has
/// @throws InputError when the light field does not say how many samples it has
std::vector<double> tile_samples_of(const LightField& picture, int replicates, int tiles);

/// A film of a rendered picture, which accepts more samples. The picture holds only the mean over
/// replicates and their scatter, in single precision. The replicates of the film are placed evenly
/// about the mean, so that estimate and standard error are those of the picture. With further
/// samples, both become those of all samples together.
/// @throws InputError when the light field does not say how many samples it has
Film film_of(const LightField& picture);

}  // namespace plenoflame
