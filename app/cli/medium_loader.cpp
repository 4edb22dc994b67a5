#include "medium_loader.h"

#include <memory>

#ifdef PLENOFLAME_HAS_VOLUMES
#include "plenoflame/volumes/load_medium.h"
#include "plenoflame/volumes/series_lattice.h"
#endif

namespace plenoflame::cli {

MediumLoader medium_loader() {
#ifdef PLENOFLAME_HAS_VOLUMES
  return load_medium;
#else
  return load_core_medium;
#endif
}

SeriesCheck series_check() {
#ifdef PLENOFLAME_HAS_VOLUMES
  return [lattice = std::make_shared<SeriesLattice>()](std::size_t flame, const FlameSpec& spec,
                                                       const std::string& folder) {
    lattice->check(flame, spec, folder);
  };
#else
  return [](std::size_t, const FlameSpec&, const std::string&) {};
#endif
}

}  // namespace plenoflame::cli
