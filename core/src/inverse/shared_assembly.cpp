#include "plenoflame/inverse/shared_assembly.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <deque>
#include <exception>
#include <functional>
#include <iterator>
#include <mutex>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "inverse/operators/csr_parts.h"
#include "inverse/operators/own_rows.h"
#include "plenoflame/base/available_memory.h"
#include "plenoflame/base/error.h"
#include "plenoflame/render/ranks.h"
#include "render/estimators/rank_bytes.h"

namespace plenoflame {
namespace {

// First bytes of the messages; what follows them. Messages of other ranks end with their epoch.
constexpr char kDraw = 'd';        ///< from rank 0: windows, box, settings
constexpr char kModel = 'l';       ///< from rank 0: what rows are, and the absorption
constexpr char kEntries = 'n';     ///< from rank 0: rows
constexpr char kMatrix = 'm';      ///< from rank 0: estimated bytes, largest share
constexpr char kParts = 'p';       ///< from rank 0: OwnRows::set_parts()
constexpr char kTimes = 'x';       ///< from rank 0: x
constexpr char kTransposed = 'y';  ///< from rank 0: the rank's part of y
constexpr char kSquares = 'q';     ///< from rank 0
constexpr char kAnswer = 'a';      ///< to rank 0: rows, entries, their starts, A x, squares of rows
constexpr char kSum = 's';         ///< to the next rank, from the last one to rank 0: TransposedSum
constexpr char kWrong = 'w';       ///< to rank 0: an error message
constexpr char kForget = 'f';      ///< from rank 0: epoch
constexpr char kEnds = 'u';        ///< from rank 0

template <class Value>
std::string message_of(char what, const std::vector<Value>& values) {
  std::string bytes(1, what);
  put_all(bytes, values);
  return bytes;
}

template <class Value>
std::vector<Value> values_of(const RankMessage& message) {
  return RankReader(std::string_view(message.bytes).substr(1)).get_all<Value>();
}

std::string message_of(const TransposedSum& sum) {
  std::string bytes = message_of(kSum, sum.whole);
  put_all(bytes, sum.open);
  return bytes;
}

TransposedSum sum_of(const RankMessage& message) {
  RankReader reader(std::string_view(message.bytes).substr(1));
  std::vector<double> whole = reader.get_all<double>();
  return {std::move(whole), reader.get_all<double>()};
}

/// A window of one view that a rank draws.
struct DrawnWindow {
  std::size_t view;
  PixelWindow window;
};

/// Windows of a rank, and about the number of their rays.
struct RankWindows {
  std::vector<DrawnWindow> windows;
  std::size_t rays;
};

/// The windows of each rank, in the order of the rows, with about equal numbers of rays.
std::vector<RankWindows> windows_of_ranks(const std::vector<CameraView>& views, const Box& box,
                                          CameraRaySettings settings, std::size_t ranks,
                                          const Execution& execution) {
  using Row = CameraRays::Row;
  const auto top = [&](int view) { return window_of(views[static_cast<std::size_t>(view)]).y; };
  settings.samples = settings.replicates;
  const CameraRays few = counted_camera_rays(views, box, settings, execution);
  std::vector<Row> starts;  // where a rank may begin: lines, or cameras with cells
  for (Row row : few.rows) {
    if (settings.cells > 0) row.row = top(row.view);
    if (starts.empty() || row.view != starts.back().view || row.row != starts.back().row)
      starts.push_back(row);
  }
  starts.push_back({static_cast<int>(views.size()), 0, 0, few.ray_count()});
  std::vector<Row> begins{{0, 0, top(0), 0}};
  for (std::size_t rank = 1; rank < ranks; ++rank) {
    const std::size_t wanted = few.ray_count() * rank / ranks;
    auto at = std::ranges::lower_bound(starts, wanted, {}, &Row::begin);
    if (at != starts.begin() && wanted - std::prev(at)->begin < at->begin - wanted) --at;
    begins.push_back(*at);
  }
  begins.push_back(starts.back());
  std::vector<RankWindows> all(ranks);
  for (std::size_t rank = 0; rank < ranks; ++rank) {
    const Row &begin = begins[rank], &end = begins[rank + 1];
    all[rank].rays = end.begin - begin.begin;
    for (auto v = static_cast<std::size_t>(begin.view); v < views.size(); ++v) {
      PixelWindow window = window_of(views[v]);
      const int bottom = window.y + window.height;
      if (static_cast<int>(v) == begin.view) window.y = begin.row;
      window.height = (static_cast<int>(v) == end.view ? end.row : bottom) - window.y;
      if (window.height > 0) all[rank].windows.push_back({v, window});
      if (static_cast<int>(v) == end.view) break;
    }
  }
  return all;
}

std::vector<CameraView> views_of(const std::vector<CameraView>& all,
                                 const std::vector<DrawnWindow>& windows) {
  std::vector<CameraView> views;
  for (const DrawnWindow& own : windows) views.push_back({all.at(own.view).scene, own.window});
  return views;
}

/// The rows of a rank, with the numbers of all views.
CameraRays drawn_rays(const std::vector<CameraView>& all, const std::vector<DrawnWindow>& windows,
                      const Box& box, const CameraRaySettings& settings,
                      const Execution& execution) {
  CameraRays rays = draw_camera_rays(views_of(all, windows), box, settings, execution);
  for (CameraRays::Row& row : rays.rows)
    row.view = static_cast<int>(windows[static_cast<std::size_t>(row.view)].view);
  return rays;
}

std::string rows_message(const CameraRays& rays) {
  std::string bytes = message_of(kAnswer, rays.rows);
  put_all(bytes, rays.pixels);
  put_all(bytes, rays.pixel_ends);
  put(bytes, rays.ray_count());
  return bytes;
}

/// Appends the rows of a rank. @param count of rays so far
void append_rows(const RankMessage& message, CameraRays& all, std::size_t& count) {
  RankReader reader(std::string_view(message.bytes).substr(1));
  for (CameraRays::Row& row : reader.get_all<CameraRays::Row>()) {
    all.rows.push_back(row);
    all.rows.back().begin += count;
  }
  const std::size_t pixels = all.pixels.size();
  for (const CameraRays::Pixel& pixel : reader.get_all<CameraRays::Pixel>())
    all.pixels.push_back(pixel);
  for (const std::size_t end : reader.get_all<std::size_t>())
    all.pixel_ends.push_back(pixels + end);
  count += reader.get<std::size_t>();
}

/// [byte] of a matrix that ranks of this machine keep, each with this share at most.
double bytes_here(double bytes, double share, const Communicator& ranks) {
  return bytes * std::min(1.0, share * ranks.ranks_on_node());
}

/// The rows of a rank, whose rays are given back. @param bytes of all rows on this machine
/// @throws InputError: there is no memory for them
CsrMatrix<float> take_matrix(EmissionProblem problem, CameraRays& rays, double bytes,
                             const Execution& execution) {
  require_memory(bytes, "the rows of the matrix on a machine",
                 "take more machines, a coarser grid, or larger blocks of pixels");
  problem.rays = &rays;
  CsrMatrix<float> matrix = make_emission_matrix(problem, execution);
  rays = {};
  return matrix;
}

std::string of_epoch(std::string bytes, int epoch) {
  put(bytes, epoch);
  return bytes;
}

/// Takes the epoch off a message.
int take_epoch(RankMessage& message) {
  const std::size_t size = message.bytes.size() - std::min(sizeof(int), message.bytes.size());
  const auto epoch = RankReader(std::string_view(message.bytes).substr(size)).get<int>();
  message.bytes.resize(size);
  return epoch;
}

/// Waits for a message of this kind and epoch, or for the error of another rank.
RankMessage wait_for(Communicator& ranks, char what, int epoch, const std::stop_token& stop = {}) {
  for (;;) {
    RankMessage message = wait_for_message(ranks, stop);
    const char got = message.bytes.front();
    if (got == rank_message::kFailed) throw Error(message.bytes.substr(1));
    if ((got != what && got != kWrong) || take_epoch(message) != epoch) continue;
    if (got == kWrong) throw Error(message.bytes.substr(1));
    return message;
  }
}

/// The answers of the other ranks; none for rank 0.
std::vector<RankMessage> answers(Communicator& ranks, int epoch, const std::stop_token& stop = {}) {
  std::vector<RankMessage> all(static_cast<std::size_t>(ranks.size()));
  for (int rank = 1; rank < ranks.size(); ++rank) {
    RankMessage message = wait_for(ranks, kAnswer, epoch, stop);
    all.at(static_cast<std::size_t>(message.from)) = std::move(message);
  }
  return all;
}

void send_all(Communicator& ranks, const std::string& bytes) {
  for (int rank = 1; rank < ranks.size(); ++rank) ranks.send(rank, bytes);
}

/// For what ends: the run ends with an error of its own.
void try_to_send_all(Communicator& ranks, const std::string& bytes) {
  try {
    send_all(ranks, bytes);
  } catch (const std::exception&) {
  }
}

/// Messages that go on during work of this rank. MPI passes long ones on in its calls only.
class BusyCommunicator final : public Communicator {
 public:
  explicit BusyCommunicator(Communicator& ranks) : ranks_(ranks) {}
  int rank() const override { return ranks_.rank(); }
  int size() const override { return ranks_.size(); }
  int ranks_on_node() const override { return ranks_.ranks_on_node(); }
  void send(int to, std::string bytes) override { ranks_.send(to, std::move(bytes)); }
  std::optional<RankMessage> receive() override {
    if (early_.empty()) return ranks_.receive();
    RankMessage first = std::move(early_.front());
    early_.pop_front();
    return first;
  }
  /// @param look sees each message that comes, and tells if the next one is to be read
  template <class Task>
  void during(const Task& task, const std::function<bool(const RankMessage&)>& look = {}) {
    std::atomic<bool> ended = false;
    std::exception_ptr failure;
    std::jthread worker([&] {
      try {
        task();
      } catch (...) {
        failure = std::current_exception();
      }
      ended = true;
    });
    for (bool reads = true; !ended;) {
      std::optional<RankMessage> message;
      if (reads) message = ranks_.receive();
      if (!message) {
        std::this_thread::sleep_for(kPause);
        continue;
      }
      reads = !look || look(*message);
      early_.push_back(std::move(*message));
    }
    if (failure) std::rethrow_exception(failure);
  }

 private:
  static constexpr std::chrono::microseconds kPause{100};
  Communicator& ranks_;
  std::deque<RankMessage> early_;
};

/// The rows of a rank above 0, and its part in products.
class ServedRows {
 public:
  ServedRows(const std::vector<CameraView>& views, const Unknowns& unknowns,
             BusyCommunicator& ranks, const Execution& execution)
      : views_(views), ranks_(ranks), execution_(execution) {
    problem_.unknowns = &unknowns;
  }

  void send(int to, std::string bytes) { ranks_.send(to, of_epoch(std::move(bytes), epoch_)); }

  void take(RankMessage message) {
    if (message.bytes.front() == kSum && take_epoch(message) != epoch_) return;
    RankReader reader(std::string_view(message.bytes).substr(1));
    switch (message.bytes.front()) {
      case kForget:
        own_.reset();
        rays_ = {};
        is_summed_ = false;
        before_.reset();
        epoch_ = reader.get<int>();
        break;
      case kDraw: {
        const auto windows = reader.get_all<DrawnWindow>();
        const auto box = reader.get<Box>();
        const auto settings = reader.get<CameraRaySettings>();
        until_asked([&](const Execution& execution) {
          rays_ = drawn_rays(views_, windows, box, settings, execution);
        });
        send(0, rows_message(rays_));
        break;
      }
      case kModel:
        problem_.model = reader.get<RowModel>();
        problem_.absorption = reader.get_all<double>();
        break;
      case kEntries: {
        problem_.rays = &rays_;
        const auto rows = reader.get_all<std::size_t>();
        std::size_t entries = 0;
        until_asked([&](const Execution& execution) {
          for (const std::size_t row : rows) {
            if (execution.stop.stop_requested()) throw Cancelled();
            entries += entries_of_rows(problem_, std::span(&row, 1));
          }
        });
        send(0, message_of(kAnswer, std::vector{entries}));
        break;
      }
      case kMatrix: {
        const auto bytes = reader.get<double>(), share = reader.get<double>();
        until_asked([&](const Execution& execution) {
          own_.emplace(take_matrix(problem_, rays_, bytes_here(bytes, share, ranks_), execution),
                       execution);
        });
        const auto starts = own_->matrix().row_starts();
        send(0, message_of(kAnswer, std::vector(starts.begin(), starts.end())));
        break;
      }
      case kParts:
        own_->set_parts(reader.get_all<std::size_t>());
        break;
      case kTimes:
        send(0, message_of(kAnswer, own_->times(reader.get_all<double>())));
        break;
      case kSquares:
        send(0, message_of(kAnswer, own_->squares()));
        break;
      case kTransposed:
        own_->sum_up(reader.get_all<double>());
        is_summed_ = true;
        pass_on();
        break;
      case kSum:
        before_ = sum_of(message);
        pass_on();
        break;
      default:
        break;
    }
  }

 private:
  /// Work that rank 0 may end.
  template <class Task>
  void until_asked(const Task& task) {
    Execution working = execution_;
    std::stop_source source;
    working.stop = source.get_token();
    const std::stop_callback stopped(execution_.stop, [&] { source.request_stop(); });
    ranks_.during([&] { task(working); },
                  [&](const RankMessage& message) {
                    constexpr std::array kEnd{kForget, kEnds, rank_message::kQuit};
                    if (std::ranges::find(kEnd, message.bytes.front()) == kEnd.end()) return true;
                    source.request_stop();
                    return false;  // what follows may be for others
                  });
  }
  /// The sum of the ranks before may come first.
  void pass_on() {
    if (!is_summed_ || !before_) return;
    own_->add_to(*before_);
    send((ranks_.rank() + 1) % ranks_.size(), message_of(*before_));
    is_summed_ = false;
    before_.reset();
  }

  const std::vector<CameraView>& views_;
  BusyCommunicator& ranks_;
  const Execution& execution_;
  int epoch_ = 0;
  EmissionProblem problem_;
  CameraRays rays_;
  std::optional<OwnRows> own_;
  bool is_summed_ = false;
  std::optional<TransposedSum> before_;
};

}  // namespace

/// The matrix, on rank 0.
class SharedAssembly::Matrix final : public LinearOperator {
 public:
  Matrix(SharedAssembly& assembly, CsrMatrix<float> matrix, const Execution& execution)
      : assembly_(assembly),
        ranks_(assembly.ranks_),
        epoch_(assembly.epoch_),
        first_(assembly.first_),
        own_(std::move(matrix), execution) {
    const auto own = own_.matrix().row_starts();
    std::vector<std::int64_t> starts(own.begin(), own.end());
    const std::vector<RankMessage> messages = answers(ranks_, epoch_, execution.stop);
    for (std::size_t rank = 1; rank < messages.size(); ++rank) {
      const std::int64_t before = starts.back();
      const auto of_rank = values_of<std::int64_t>(messages[rank]);
      for (std::size_t i = 1; i < of_rank.size(); ++i) starts.push_back(before + of_rank[i]);
    }
    const std::vector<std::size_t> parts = csr_parts(starts, columns());
    for (std::size_t rank = 0; rank < messages.size(); ++rank) {
      std::vector<std::size_t> of_rank;
      for (const std::size_t row : parts)
        if (row >= first_[rank] && row <= first_[rank + 1]) of_rank.push_back(row - first_[rank]);
      if (rank == 0)
        own_.set_parts(of_rank);
      else
        ranks_.send(static_cast<int>(rank), message_of(kParts, of_rank));
    }
  }
  ~Matrix() override {
    if (assembly_.epoch_ == epoch_) assembly_.forget();
  }
  std::size_t rows() const override { return first_.back(); }
  std::size_t columns() const override { return own_.matrix().columns(); }

  void apply(std::span<const double> x, std::span<double> y) const override {
    const std::lock_guard lock(mutex_);
    send_all(ranks_, message_of(kTimes, std::vector(x.begin(), x.end())));
    gather([&] { return own_.times(x); }, y);
  }

  void apply_transpose(std::span<const double> y, std::span<double> x) const override {
    const std::lock_guard lock(mutex_);
    for (std::size_t rank = 1; rank + 1 < first_.size(); ++rank) {
      const std::span<const double> part = of_rank(y, rank);
      ranks_.send(static_cast<int>(rank),
                  message_of(kTransposed, std::vector(part.begin(), part.end())));
    }
    TransposedSum sum{std::vector(columns(), 0.0), {}};
    ranks_.during([&] {
      own_.sum_up(of_rank(y, 0));
      own_.add_to(sum);
    });
    ranks_.send(1, of_epoch(message_of(sum), epoch_));
    std::ranges::copy(sum_of(wait_for(ranks_, kSum, epoch_)).whole, x.begin());
  }

  double squared_norm(std::span<const double> weights) const override {
    const std::lock_guard lock(mutex_);
    send_all(ranks_, std::string(1, kSquares));
    std::vector<double> squares(rows());
    gather([&] { return own_.squares(); }, squares);
    double sum = 0;
    for (std::size_t i = 0; i < squares.size(); ++i)
      sum += squares[i] * (weights.empty() ? 1 : weights[i] * weights[i]);
    return sum;
  }

 private:
  template <class Value>
  std::span<Value> of_rank(std::span<Value> all, std::size_t rank) const {
    return all.subspan(first_[rank], first_[rank + 1] - first_[rank]);
  }
  /// Puts the numbers of all rows in order: this rank's and the answers.
  template <class Own>
  void gather(const Own& own, std::span<double> all) const {
    ranks_.during([&] { std::ranges::copy(own(), all.begin()); });
    const std::vector<RankMessage> messages = answers(ranks_, epoch_);
    for (std::size_t rank = 1; rank < messages.size(); ++rank)
      std::ranges::copy(values_of<double>(messages[rank]), of_rank(all, rank).begin());
  }

  SharedAssembly& assembly_;
  mutable BusyCommunicator ranks_;
  int epoch_;
  std::vector<std::size_t> first_;
  mutable OwnRows own_;
  mutable std::mutex mutex_;
};

SharedAssembly::~SharedAssembly() {
  try_to_send_all(ranks_, std::string(1, kEnds));
}

bool SharedAssembly::can_share(std::size_t cameras, const CameraRaySettings& settings) const {
  const auto ranks = static_cast<std::size_t>(ranks_.size());
  return ranks > 1 && (settings.cells == 0 || cameras >= ranks);
}

double SharedAssembly::memory(double bytes, std::size_t columns) const {
  return bytes_here(bytes, largest_, ranks_) +
         static_cast<double>(sizeof(double) * columns) * ranks_.size();
}

void SharedAssembly::forget() {
  own_ = {};
  try_to_send_all(ranks_, of_epoch(std::string(1, kForget), ++epoch_));
}

CameraRays SharedAssembly::rays(const std::vector<CameraView>& views, const Box& box,
                                OperatorForm form, const CameraRaySettings& settings,
                                const Execution& execution) {
  forget();
  const auto ranks = static_cast<std::size_t>(ranks_.size());
  const auto windows = windows_of_ranks(views, box, settings, ranks, execution);
  const RankWindows& most = *std::ranges::max_element(windows, {}, &RankWindows::rays);
  std::size_t all_rays = 0;
  for (const RankWindows& own : windows) all_rays += own.rays;
  largest_ = all_rays > 0 ? static_cast<double>(most.rays) / static_cast<double>(all_rays) : 1;
  const CameraRaySettings how = kept_or_drawn(form, views_of(views, most.windows), box, settings,
                                              execution, ranks_.ranks_on_node());
  for (std::size_t rank = 1; rank < ranks; ++rank) {
    std::string bytes = message_of(kDraw, windows[rank].windows);
    put(bytes, box);
    put(bytes, how);
    ranks_.send(static_cast<int>(rank), std::move(bytes));
  }
  own_ = drawn_rays(views, windows[0].windows, box, how, execution);
  std::vector<RankMessage> rows = answers(ranks_, epoch_, execution.stop);
  rows[0].bytes = rows_message(own_);
  CameraRays all;
  std::size_t count = 0;
  first_.clear();
  for (const RankMessage& message : rows) {
    first_.push_back(all.rows.size());
    append_rows(message, all, count);
  }
  first_.push_back(all.rows.size());
  draw_again(views, box, settings, count, all);
  return all;
}

std::size_t SharedAssembly::entries(const EmissionProblem& problem) {
  std::string model(1, kModel);
  put(model, problem.model);
  put_all(model, problem.absorption);
  send_all(ranks_, model);
  const std::vector<std::size_t> sample = sampled_rows(*problem.rays);
  if (sample.empty()) return 0;
  std::size_t entries = 0;
  for (std::size_t rank = first_.size() - 1; rank-- > 0;) {
    std::vector<std::size_t> rows;
    for (const std::size_t row : sample)
      if (row >= first_[rank] && row < first_[rank + 1]) rows.push_back(row - first_[rank]);
    if (rank > 0) {
      ranks_.send(static_cast<int>(rank), message_of(kEntries, rows));
      continue;
    }
    EmissionProblem own = problem;
    own.rays = &own_;
    entries = entries_of_rows(own, rows);
  }
  for (const RankMessage& message : answers(ranks_, epoch_))
    if (message.from > 0) entries += values_of<std::size_t>(message).front();
  return entries * problem.rays->rows.size() / sample.size();
}

std::unique_ptr<LinearOperator> SharedAssembly::matrix(const EmissionProblem& problem, double bytes,
                                                       const Execution& execution) {
  std::string message(1, kMatrix);
  put(message, bytes);
  put(message, largest_);
  send_all(ranks_, message);
  bytes = bytes_here(bytes, largest_, ranks_);
  return std::make_unique<Matrix>(*this, take_matrix(problem, own_, bytes, execution), execution);
}

bool serve_assembly(const std::vector<CameraView>& views, const Unknowns& unknowns,
                    Communicator& ranks, const Execution& execution) {
  BusyCommunicator busy(ranks);
  ServedRows rows(views, unknowns, busy, execution);
  for (;;) {
    RankMessage message = wait_for_message(busy);
    if (message.bytes.front() == kEnds) return true;
    if (message.bytes.front() == rank_message::kQuit) return false;
    const auto failed = [&](const std::string& what) { rows.send(0, kWrong + what); };
    try {
      rows.take(std::move(message));
    } catch (const std::bad_alloc&) {
      failed("a rank has not enough memory");
    } catch (const Cancelled&) {
      failed("a rank was stopped; the same command begins anew");
    } catch (const std::exception& error) {
      failed(error.what());
    }
  }
}

}  // namespace plenoflame
