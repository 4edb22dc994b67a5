#pragma once
#include "plenoflame/film/film.h"
#include "render/tracer/film_sums.h"
#include "render/tracer/pixel_sampler.h"
#include "render/tracer/radiance_integrator.h"

namespace plenoflame {

/// Makes a picture from the rays of a plan: sampler, integrator and film in sequence. One object
/// per worker thread.
template <class Real>
class PictureTracer : public RayConsumer<Real> {
 public:
  PictureTracer(const BackwardPlan<Real>& plan, Film& film)
      : film_(film), sampler_(plan, *this), integrator_(plan), sums_(plan, film) {}
  PictureTracer(const PictureTracer&) = delete;
  PictureTracer& operator=(const PictureTracer&) = delete;

  void render(int tile) { sampler_.trace(tile, film_.tile(tile)); }
  double rays() const { return sampler_.counters().rays; }
  WorkCounters counters() const {
    WorkCounters all = sampler_.counters();
    all += integrator_.counters();
    all.table += sums_.table_counters();
    return all;
  }

  void begin_tile(int index, const PixelWindow& tile) override { sums_.begin_tile(index, tile); }
  void traced(const TracedRays<Real>& rays) override {
    integrator_.integrate(rays);
    sums_.add(rays, integrator_.radiance());
  }

 private:
  Film& film_;
  PixelSampler<Real> sampler_;
  RadianceIntegrator<Real> integrator_;
  FilmSums<Real> sums_;
};

}  // namespace plenoflame
