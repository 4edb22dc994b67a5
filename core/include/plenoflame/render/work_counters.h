#pragma once
#include "plenoflame/media/medium.h"

namespace plenoflame {

/// Counts of a table that stands in for the medium (RadianceTable).
struct TableCounters {
  double looked_up = 0;  ///< rays whose radiance is the table's
  double corrected = 0;  ///< rays that were integrated to correct the table
  double rough = 0;      ///< rays integrated because the table is not smooth there
  double nodes = 0;      ///< rays integrated to fill the table
  /// Sums (of a pixel's rays through one microlens, of one randomisation) that a correction made
  /// negative and that count as 0, and what that adds to the picture's sum, which is `total` (both
  /// in the same arbitrary unit).
  double clamped = 0, clamped_sum = 0, total = 0;
  TableCounters& operator+=(const TableCounters& other);
};

/// Seconds that the stages of rendering took, summed over threads.
struct StageSeconds {
  double generate = 0, optics = 0, medium = 0, surfaces = 0;
  StageSeconds& operator+=(const StageSeconds& other);
};

/// Counts of the work that was done: those of all workers, tiles and rounds are added up.
struct WorkCounters {
  double rays = 0;            ///< sent
  double rays_reached = 0;    ///< of these, left the camera towards the scene (forward: arrived on
                              ///< the sensor)
  double pairs = 0;           ///< pixels x microlenses that cover them
  double pairs_skipped = 0;   ///< whose beams miss the flame while others of the lens do not
  double pixels_skipped = 0;  ///< without array: pixels whose beams miss the flame
  double tiles = 0;           ///< of the film that were rendered, in all rounds
  double tiles_skipped = 0;   ///< of these, without any ray
  MediumCounters medium;
  TableCounters table;
  StageSeconds stages;
  WorkCounters& operator+=(const WorkCounters& other);
};

}  // namespace plenoflame
