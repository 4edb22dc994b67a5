#pragma once
#include "plenoflame/media/medium.h"

namespace plenoflame {

/// Counts of a table that replaces the medium (RadianceTable).
struct TableCounters {
  double looked_up = 0;  ///< rays whose radiance comes from the table
  double corrected = 0;  ///< rays that were integrated to correct the table
  double rough = 0;      ///< rays integrated because the table is not smooth there
  double nodes = 0;      ///< rays integrated to fill the table
  /// `clamped` counts sums (of a pixel's rays through one microlens, of one replicate) that a
  /// correction made negative. They count as 0, which adds `clamped_sum` to the picture's sum
  /// `total`. Both have the same arbitrary unit.
  double clamped = 0, clamped_sum = 0, total = 0;
  TableCounters& operator+=(const TableCounters& other);
};

/// Seconds that the stages of rendering took, summed over threads.
struct StageSeconds {
  double generate = 0, optics = 0, medium = 0, surfaces = 0;
  StageSeconds& operator+=(const StageSeconds& other);
};

/// Counts of the work that was done, added up over all workers, tiles and rounds.
struct WorkCounters {
  double rays = 0;  ///< rays that were started
  /// Rays that left the camera towards the scene (forward: arrived on the sensor).
  double rays_reached = 0;
  double pairs = 0;           ///< pixels x microlenses that cover them
  double pairs_skipped = 0;   ///< pairs whose beams miss the flame; the lens has others
  double pixels_skipped = 0;  ///< without array: pixels whose beams miss the flame
  double tiles = 0;           ///< rendered tiles of the film, in all rounds
  double tiles_skipped = 0;   ///< tiles without any ray
  MediumCounters medium;
  TableCounters table;
  StageSeconds stages;
  WorkCounters& operator+=(const WorkCounters& other);
};

}  // namespace plenoflame
