#include "model/jobs/reconstruct_job.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/render/describe.h"
#include "plenoflame/render/render_request.h"
#include "plenoflame/volumes/load_medium.h"
#include "reconstruct_settings.h"

namespace plenoflame::desktop {
namespace {

constexpr std::chrono::milliseconds kIterateInterval{150};  ///< between two pictures of the iterate

/// The box that holds every unknown, so that iterates of any values have one lattice.
IndexBox box_of_all(const Unknowns& unknowns, AffineTransform& transform) {
  const std::vector<double> ones(unknowns.size(), 1.0);
  const VoxelField field = unknowns.field(ones, "all");
  transform = field.index_to_world;
  return stored_box(field);
}

std::vector<float> dense(const Unknowns& unknowns, const std::vector<double>& values,
                         const IndexBox& box) {
  return voxel_values(unknowns.field(values, "values"), box).values;
}

double largest_of(const std::vector<float>& values) {
  return values.empty() ? 0 : static_cast<double>(*std::max_element(values.begin(), values.end()));
}

/// Truth of a reconstructed field; null: unknown.
const std::vector<double>* truth_of(const std::string& name, const FlameTruth* truth) {
  if (!truth) return nullptr;
  const std::vector<double>* const values = name == "emission"      ? &truth->emission
                                            : name == "temperature" ? &truth->temperature
                                            : name == "absorption"  ? &truth->absorption
                                                                    : nullptr;
  return values && !values->empty() ? values : nullptr;
}

ReconstructFields fields_of(const FlameReconstruction& found) {
  const Unknowns& unknowns = found.unknowns();
  AffineTransform transform;
  const IndexBox box = box_of_all(unknowns, transform);
  ReconstructFields out;
  out.place = voxel_place(transform, box);
  for (const ReconstructedField& field : reconstructed_fields(found.result)) {
    ReconstructFields::Field entry{
        field.name, field.unit, dense(unknowns, *field.values, box), {}, 0};
    if (const auto* truth = truth_of(field.name, found.reconstructor->truth()))
      entry.truth = dense(unknowns, *truth, box);
    entry.largest = std::max(largest_of(entry.found), largest_of(entry.truth));
    out.fields.push_back(std::move(entry));
  }
  return out;
}

std::shared_ptr<const LightField> picture_of(const ReconstructSource& source,
                                             const CompiledScene& scene,
                                             const Execution& execution) {
  if (source.picture) return source.picture;
  if (!source.file.empty())
    return std::make_shared<const LightField>(read_light_field(source.file, execution.stop));
  Execution quiet = execution;
  quiet.progress = nullptr;
  RenderResult result = render(scene, render_settings(scene.scene), quiet);
  if (!result.statistics.complete) throw Cancelled();
  describe(scene, result.light_field);
  return std::make_shared<const LightField>(std::move(result.light_field));
}

}  // namespace

Image ReconstructFields::slice(const std::vector<float>& values, int axis, double share) const {
  const int across = axis == 0 ? 1 : 0, up = axis == 2 ? 1 : 2;
  const auto count = [&](int k) {
    return static_cast<int>(place.size[static_cast<std::size_t>(k)]);
  };
  if (values.empty() || count(0) * count(1) * count(2) == 0) return {};
  const int fixed = std::clamp(static_cast<int>(share * count(axis)), 0, count(axis) - 1);
  Image image(count(across), count(up));
  for (int row = 0; row < image.height; ++row)
    for (int column = 0; column < image.width; ++column) {
      std::array<std::size_t, 3> at{};
      at[static_cast<std::size_t>(axis)] = static_cast<std::size_t>(fixed);
      at[static_cast<std::size_t>(across)] = static_cast<std::size_t>(column);
      at[static_cast<std::size_t>(up)] = static_cast<std::size_t>(image.height - 1 - row);
      image.at(column, row) = values[(at[2] * place.size[1] + at[1]) * place.size[0] + at[0]];
    }
  return image;
}

struct ReconstructJob::Run {
  std::vector<ReconstructSource> sources;
  Options options;
  // The following belong to the worker's thread.
  std::chrono::steady_clock::time_point told, begun, share_told;
  QVector<QPointF> trials, solution;  ///< not reported yet
  int iterations = 0;
  bool has_box = false;
  IndexBox box;
  AffineTransform transform;
};

ReconstructJob::ReconstructJob(QObject* parent) : QObject(parent) {}

void ReconstructJob::set_state(State state) {
  state_ = state;
  emit state_changed();
}

void ReconstructJob::start(std::vector<ReconstructSource> sources, const Options& options) {
  auto run = std::make_shared<Run>();
  run->sources = std::move(sources);
  run->options = options;
  run_ = run;
  trials_.clear();
  solution_.clear();
  fields_ = nullptr;
  result_ = nullptr;
  report_.clear();
  share_ = 0;
  remaining_seconds_ = -1;
  stopping_ = false;
  text_ = tr("preparing the cameras");
  set_state(State::running);
  emit progressed();
  task_.request([this, run](const std::stop_token& stop) { this->run(run, stop); });
}

void ReconstructJob::stop() {
  if (state_ != State::running) return;
  stopping_ = true;
  text_ = tr("stopping");
  task_.cancel();
  emit progressed();
}

void ReconstructJob::watch(const std::shared_ptr<Run>& run, const ReconstructionState& state,
                           const Unknowns& unknowns) {
  const QPointF point(++run->iterations, state.chi_squared);
  (state.choosing ? run->trials : run->solution) << point;
  const auto now = std::chrono::steady_clock::now();
  if (now - run->told < kIterateInterval) return;
  run->told = now;
  if (!run->has_box) run->box = box_of_all(unknowns, run->transform);
  run->has_box = true;
  auto fields = std::make_shared<ReconstructFields>();
  fields->place = voxel_place(run->transform, run->box);
  ReconstructFields::Field field;
  field.name = std::string(state.temperatures ? "temperature" : "iterate");
  if (state.temperatures) field.unit = std::string("K");
  field.found = dense(unknowns, {state.values.begin(), state.values.end()}, run->box);
  field.largest = largest_of(field.found);
  fields->fields.push_back(std::move(field));
  post(this, [this, run, fields, trials = std::exchange(run->trials, {}),
              solution = std::exchange(run->solution, {}), choosing = state.choosing, point] {
    if (run != run_ || state_ != State::running) return;
    trials_ << trials;
    solution_ << solution;
    fields_ = fields;
    if (!stopping_)
      text_ = (choosing ? tr("trying strengths of the penalty, iteration %1: chi^2 per row %2")
                        : tr("iteration %1: chi^2 per row %2"))
                  .arg(point.x())
                  .arg(point.y(), 0, 'g', 4);
    emit progressed();
  });
}

void ReconstructJob::tell_share(const std::shared_ptr<Run>& run, double share) {
  const auto now = std::chrono::steady_clock::now();
  if (share <= 0 || now - run->share_told < kIterateInterval) return;
  run->share_told = now;
  const double spent = std::chrono::duration<double>(now - run->begun).count();
  post(this, [this, run, share, left = spent * (1 - share) / share] {
    if (run != run_ || state_ != State::running) return;
    share_ = share;
    remaining_seconds_ = left;
    emit progressed();
  });
}

void ReconstructJob::run(const std::shared_ptr<Run>& run, const std::stop_token& stop) {
  Execution execution;
  execution.stop = stop;
  execution.message = [this](Severity severity, const std::string& text) {
    if (severity == Severity::warning)
      post(this, [this, text] { emit warned(QString::fromStdString(text)); });
  };
  const auto say = [&](const QString& text) {
    post(this, [this, run, text] {
      if (run != run_ || state_ != State::running || stopping_) return;
      text_ = text;
      emit progressed();
    });
  };
  const auto fail = [&](const QString& text, State state) {
    post(this, [this, run, text, state] {
      if (run != run_) return;
      text_ = text;
      set_state(state);
      emit progressed();
    });
  };
  try {
    ReconstructRequest request;
    request.unknowns.names = kWordNames;
    for (const auto& [name, text] : run->options) set_option(request, name, text);
    std::vector<CameraPicture> pictures;
    for (const ReconstructSource& source : run->sources) {
      say(tr("reading camera and picture: %1").arg(QString::fromStdString(source.what)));
      auto scene = std::make_shared<const CompiledScene>(
          compile(Document::at_moment(source.scene, source.time), load_medium, execution,
                  source.scene.positions));
      const auto picture = picture_of(source, *scene, execution);
      pictures.push_back({scene, *picture, camera_text(source.camera), source.what});
    }
    say(tr("following rays"));
    run->begun = std::chrono::steady_clock::now();
    execution.progress = [&](const Progress& progress) { tell_share(run, progress.fraction); };
    const std::shared_ptr<const FlameReconstruction> found =
        reconstruct_flame(request, std::move(pictures), execution,
                          [&](const ReconstructionState& state, const Unknowns& unknowns) {
                            watch(run, state, unknowns);
                          });
    auto fields = std::make_shared<const ReconstructFields>(fields_of(*found));
    post(this, [this, run, found, fields, trials = run->trials, solution = run->solution] {
      if (run != run_) return;
      trials_ << trials;
      solution_ << solution;
      fields_ = fields;
      result_ = found;
      report_ = QString::fromStdString(found->report.text());
      text_ = found->result.figures.complete ? tr("finished")
                                             : tr("stopped: this is what was reached by then");
      set_state(State::finished);
      emit progressed();
    });
  } catch (const Cancelled&) {
    fail(tr("stopped before there was a result"), State::idle);
  } catch (const std::exception& error) {
    fail(QString::fromUtf8(error.what()), State::failed);
  }
}

}  // namespace plenoflame::desktop
