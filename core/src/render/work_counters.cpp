#include "plenoflame/render/work_counters.h"

namespace plenoflame {

TableCounters& TableCounters::operator+=(const TableCounters& other) {
  looked_up += other.looked_up;
  corrected += other.corrected;
  rough += other.rough;
  nodes += other.nodes;
  clamped += other.clamped;
  clamped_sum += other.clamped_sum;
  total += other.total;
  return *this;
}

StageSeconds& StageSeconds::operator+=(const StageSeconds& other) {
  generate += other.generate;
  optics += other.optics;
  medium += other.medium;
  surfaces += other.surfaces;
  return *this;
}

WorkCounters& WorkCounters::operator+=(const WorkCounters& other) {
  rays += other.rays;
  rays_reached += other.rays_reached;
  pairs += other.pairs;
  pairs_skipped += other.pairs_skipped;
  pixels_skipped += other.pixels_skipped;
  tiles += other.tiles;
  tiles_skipped += other.tiles_skipped;
  medium += other.medium;
  table += other.table;
  stages += other.stages;
  return *this;
}

}  // namespace plenoflame
