#pragma once
#include <functional>
#include <vector>

#include "camera/block_tracing.h"
#include "plenoflame/camera/camera.h"

namespace plenoflame {

/// Traces many rays from the sensor through one kind of microlens, in double precision, for pupil
/// tables. The microlens may be anywhere on the x axis.
class PupilTracer {
 public:
  /// @param open the microlens' own apertures block nothing: only the main lens blocks rays
  PupilTracer(const Camera& camera, int type, bool open);
  virtual ~PupilTracer() = default;

  /// A ray from the sensor point s to the point u of the aim plane, both relative to the centre of
  /// the microlens [m].
  struct Request {
    Vec2 s, u;
  };
  /// Receives the number of a request and whether its ray reaches the scene. A ray that reaches it
  /// has its place and direction in the plane z = 0 of the camera frame.
  using Answer = std::function<void(std::size_t index, bool passes, const Ray& ray)>;
  /// @param h distance of the microlens' centre from the optical axis [m]
  virtual void trace(double h, const std::vector<Request>& requests, const Answer& answer);

  /// Receives the number of a request and whether its ray passes the microlens. The ray behind it
  /// is relative to the microlens' centre, with z from the front of the array.
  using Emergence = std::function<void(std::size_t index, bool emerges, const Ray& ray)>;
  void leave_microlens(const std::vector<Request>& requests, const Emergence& emergence);

 protected:
  /// @param place of the lens @param lens its kernel @param turn of the requests' axes
  void trace_at(Vec2 place, const KernelMicrolens<double>& lens, Vec2 turn,
                const std::vector<Request>& requests, const Answer& answer);
  KernelMicrolens<double> lens_;

 private:
  /// Fills the block with rays of requests [first, first + count). @param turn of their axes
  void start(const std::vector<Request>& requests, std::size_t first, std::size_t count, double z,
             Vec2 turn);
  Ray ray(std::size_t i) const;

  KernelCamera<double> camera_;
  CameraKernels<double> kernels_;
  std::vector<double> storage_;
  std::vector<int> codes_;
  KernelBlock<double> block_{};
};

/// The same for a camera in which microlenses at the same distance from the axis differ. Every call
/// uses another azimuth and another focal length. `h` counts from Camera::foot().
class MisalignedPupilTracer : public PupilTracer {
 public:
  MisalignedPupilTracer(const Camera& camera, int type);
  void trace(double h, const std::vector<Request>& requests, const Answer& answer) override;
  /// Traces through the microlens of the last call, with the same azimuth and focal length.
  void trace_again(double h, const std::vector<Request>& requests, const Answer& answer);

 private:
  const Camera& misaligned_;
  int type_;
  double turn_ = 0, factor_ = 0;  ///< values of the last call, in [0, 1)
};

}  // namespace plenoflame
