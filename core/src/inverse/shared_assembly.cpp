#include "plenoflame/inverse/shared_assembly.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <functional>
#include <new>
#include <numeric>
#include <string>
#include <string_view>
#include <thread>
#include <tuple>
#include <utility>

#include "plenoflame/base/error.h"
#include "plenoflame/film/film.h"
#include "plenoflame/render/ranks.h"
#include "render/estimators/rank_bytes.h"

namespace plenoflame {
namespace {

using namespace std::chrono_literals;

// First bytes of the messages within an assembly; what follows them.
constexpr char kReady = 'y';  ///< to rank 0
constexpr char kDraw = 'd';   ///< from rank 0: piece, number of the view, its window, box, settings
constexpr char kRows = 'm';   ///< from rank 0: piece, rays of some rows
constexpr char kModel = 'l';  ///< from rank 0: what rows are, and the absorption
constexpr char kPiece = 'p';  ///< to rank 0: piece and its results
constexpr char kEnds = 'u';   ///< from rank 0

constexpr auto kPause = 1ms;
constexpr int kAhead = 2;                                   ///< pieces that a rank has at a time
constexpr std::size_t kRaysOfPiece = std::size_t{1} << 18;  ///< some 20 MB
constexpr std::size_t kRowsOfPiece = 8192;
/// Rays of a single microlens that a piece may have: several times as many still fit a message.
constexpr std::size_t kMostRays = std::size_t{1} << 21;

void put_rays(std::string& bytes, const CameraRays& rays) {
  put_all(bytes, rays.rows);
  put_all(bytes, rays.rays);
}

CameraRays get_rays(RankReader& reader) {
  CameraRays rays;
  rays.rows = reader.get_all<CameraRays::Row>();
  rays.rays = reader.get_all<CameraRay>();
  return rays;
}

/// A window of one view that is drawn at a time.
struct DrawnPiece {
  std::size_t view;
  PixelWindow window;
};

/// The views in pieces of whole tiles and blocks of pixels: their rays do not depend on the
/// others'. Empty where pieces would be too large.
std::vector<DrawnPiece> pieces_of(const std::vector<CameraView>& views,
                                  const CameraRaySettings& settings) {
  const std::int64_t step =
      settings.bin == 1 ? Film::kTile : std::lcm<std::int64_t>(settings.bin, Film::kTile);
  const auto in_tile =
      static_cast<std::size_t>(step * step) * static_cast<std::size_t>(settings.samples);
  if (in_tile > kMostRays) return {};
  const int down = static_cast<int>(step);
  const int across = down * static_cast<int>(std::max<std::size_t>(1, kRaysOfPiece / in_tile));
  std::vector<DrawnPiece> pieces;
  for (std::size_t v = 0; v < views.size(); ++v) {
    const PixelWindow all = window_of(views[v]);
    for (int y = 0; y < all.height; y += down)
      for (int x = 0; x < all.width; x += across)
        pieces.push_back({v,
                          {all.x + x, all.y + y, std::min(across, all.width - x),
                           std::min(down, all.height - y)}});
  }
  return pieces;
}

CameraRays draw_piece(const CameraView& view, std::size_t number, const PixelWindow& window,
                      const Box& box, const CameraRaySettings& settings,
                      const Execution& execution) {
  CameraView part = view;
  part.window = window;
  CameraRays rays = draw_camera_rays({part}, box, settings, execution);
  for (CameraRays::Row& row : rays.rows) row.view = static_cast<int>(number);
  return rays;
}

/// Puts pieces together in the order of the whole: by view, line and column.
CameraRays joined(std::vector<CameraRays> pieces) {
  struct Place {
    int view, row, column;
    std::size_t piece, number;
  };
  std::vector<Place> places;
  std::vector<std::size_t> left;  // rows of each piece that are not copied yet
  std::size_t rays = 0;
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    left.push_back(pieces[p].rows.size());
    rays += pieces[p].rays.size();
    for (std::size_t i = 0; i < pieces[p].rows.size(); ++i) {
      const CameraRays::Row& row = pieces[p].rows[i];
      places.push_back({row.view, row.row, row.column, p, i});
    }
  }
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
    return std::tie(a.view, a.row, a.column) < std::tie(b.view, b.row, b.column);
  });
  CameraRays all;
  all.rows.reserve(places.size());
  all.rays.reserve(rays);
  for (const Place& place : places) {
    CameraRays& piece = pieces[place.piece];
    CameraRays::Row row = piece.rows[place.number];
    const auto begin = static_cast<std::ptrdiff_t>(row.begin),
               end = static_cast<std::ptrdiff_t>(piece.end_of(place.number));
    row.begin = all.rays.size();
    all.rows.push_back(row);
    all.rays.insert(all.rays.end(), piece.rays.begin() + begin, piece.rays.begin() + end);
    if (--left[place.piece] == 0) piece = {};
  }
  return all;
}

/// Some rows one after the other, with their rays.
CameraRays some_rows(const CameraRays& all, std::size_t first, std::size_t end) {
  CameraRays some;
  const std::size_t from = all.rows[first].begin, to = all.end_of(end - 1);
  some.rows.assign(all.rows.begin() + static_cast<std::ptrdiff_t>(first),
                   all.rows.begin() + static_cast<std::ptrdiff_t>(end));
  for (CameraRays::Row& row : some.rows) row.begin -= from;
  some.rays.assign(all.rays.begin() + static_cast<std::ptrdiff_t>(from),
                   all.rays.begin() + static_cast<std::ptrdiff_t>(to));
  return some;
}

}  // namespace

/// Pieces, of which each is made here or elsewhere.
struct SharedAssembly::Work {
  std::size_t pieces = 0;
  std::function<std::string(std::size_t)> message;
  std::function<void(std::size_t, RankReader&)> take;
  std::function<void(std::size_t)> make;
};

SharedAssembly::SharedAssembly(Communicator& ranks)
    : ranks_(ranks),
      out_(static_cast<std::size_t>(ranks.size()), 0),
      ready_(static_cast<std::size_t>(ranks.size()), 0) {}

SharedAssembly::~SharedAssembly() {
  try {
    for (int rank = 1; rank < ranks_.size(); ++rank) ranks_.send(rank, std::string(1, kEnds));
  } catch (const std::exception&) {
    // The run ends with an error of its own.
  }
}

/// @return whether a message had come
bool SharedAssembly::take(const Work& work) {
  const std::optional<RankMessage> message = ranks_.receive();
  if (!message) return false;
  const auto from = static_cast<std::size_t>(message->from);
  RankReader reader(std::string_view(message->bytes).substr(1));
  switch (message->bytes.front()) {
    case kReady:
      ready_.at(from) = 1;
      break;
    case kPiece:
      --out_.at(from);
      work.take(reader.get<std::size_t>(), reader);
      break;
    case rank_message::kFailed:
      throw Error(message->bytes.substr(1));
    default:
      break;
  }
  return true;
}

void SharedAssembly::share(const Work& work, const Execution& execution) {
  std::atomic<std::size_t> next = 0;  // the first piece that no rank has
  std::exception_ptr failure;
  std::atomic<bool> ends = false;
  const auto out = [&] { return std::accumulate(out_.begin(), out_.end(), 0); };
  std::jthread service([&] {
    try {
      while (!ends && !execution.stop.stop_requested() && (next < work.pieces || out() > 0)) {
        const bool came = take(work);
        for (int rank = 1; rank < ranks_.size(); ++rank) {
          const auto r = static_cast<std::size_t>(rank);
          while (ready_[r] && out_[r] < kAhead) {
            const std::size_t piece = next++;
            if (piece >= work.pieces) break;
            ranks_.send(rank, work.message(piece));
            ++out_[r];
          }
        }
        if (!came) std::this_thread::sleep_for(kPause);
      }
    } catch (...) {
      failure = std::current_exception();
      next = work.pieces;
    }
  });
  try {
    while (!execution.stop.stop_requested()) {
      const std::size_t piece = next++;
      if (piece >= work.pieces) break;
      work.make(piece);
    }
  } catch (...) {
    ends = true;
    service.join();
    throw;
  }
  service.join();
  if (failure) std::rethrow_exception(failure);
  if (execution.stop.stop_requested()) throw Cancelled();
}

CameraRays SharedAssembly::rays(const std::vector<CameraView>& views, const Box& box,
                                const CameraRaySettings& settings, const Execution& execution) {
  // Micro-images lie across the pieces.
  if (settings.bin < 1 || settings.cells != 0)
    return draw_camera_rays(views, box, settings, execution);
  const std::vector<DrawnPiece> pieces = pieces_of(views, settings);
  if (pieces.size() < 2) return draw_camera_rays(views, box, settings, execution);
  std::vector<CameraRays> made(pieces.size());
  Execution quiet = execution;
  quiet.progress = nullptr;
  Work work;
  work.pieces = pieces.size();
  work.message = [&](std::size_t p) {
    std::string bytes(1, kDraw);
    put(bytes, p);
    put(bytes, pieces[p].view);
    put(bytes, pieces[p].window);
    put(bytes, box);
    put(bytes, settings);
    return bytes;
  };
  work.take = [&](std::size_t p, RankReader& reader) { made.at(p) = get_rays(reader); };
  work.make = [&](std::size_t p) {
    const DrawnPiece& piece = pieces[p];
    made[p] = draw_piece(views[piece.view], piece.view, piece.window, box, settings, quiet);
    if (execution.progress)
      execution.progress({.fraction = static_cast<double>(p) / static_cast<double>(made.size())});
  };
  share(work, execution);
  return joined(std::move(made));
}

CsrMatrix<float> SharedAssembly::matrix(const EmissionProblem& problem,
                                        const Execution& execution) {
  const CameraRays& all = *problem.rays;
  if (all.source) return make_emission_matrix(problem, execution);
  std::vector<std::size_t> begins{0};
  for (std::size_t i = 1; i < all.rows.size(); ++i)
    if (i - begins.back() >= kRowsOfPiece ||
        all.end_of(i) - all.rows[begins.back()].begin > kRaysOfPiece)
      begins.push_back(i);
  if (begins.size() < 2) return make_emission_matrix(problem, execution);
  std::string model(1, kModel);
  put(model, problem.model);
  put_all(model, problem.absorption);
  for (int rank = 1; rank < ranks_.size(); ++rank) ranks_.send(rank, model);
  const auto piece = [&](std::size_t p) {
    return some_rows(all, begins[p], p + 1 < begins.size() ? begins[p + 1] : all.rows.size());
  };
  std::vector<CsrRows<float>> made(begins.size());
  Execution quiet = execution;
  quiet.progress = nullptr;
  Work work;
  work.pieces = made.size();
  work.message = [&](std::size_t p) {
    std::string bytes(1, kRows);
    put(bytes, p);
    put_rays(bytes, piece(p));
    return bytes;
  };
  work.take = [&](std::size_t p, RankReader& reader) {
    CsrRows<float>& rows = made.at(p);
    rows.counts = reader.get_all<std::size_t>();
    rows.columns = reader.get_all<std::int32_t>();
    rows.values = reader.get_all<float>();
  };
  work.make = [&](std::size_t p) {
    const CameraRays rays = piece(p);
    EmissionProblem own = problem;
    own.rays = &rays;
    made[p] = make_emission_rows(own, quiet);
    if (execution.progress)
      execution.progress({.fraction = static_cast<double>(p) / static_cast<double>(made.size())});
  };
  share(work, execution);
  return join_rows(std::move(made), problem.unknowns->size());
}

CameraRays rays_by(SharedAssembly* assembly, OperatorForm form,
                   const std::vector<CameraView>& views, const Box& box,
                   const CameraRaySettings& settings, const Execution& execution) {
  const CameraRaySettings how = kept_or_drawn(form, views, box, settings, execution);
  return assembly && how.keep ? assembly->rays(views, box, how, execution)
                              : draw_camera_rays(views, box, how, execution);
}

bool serve_assembly(const std::vector<CameraView>& views, const Unknowns& unknowns,
                    Communicator& ranks, const Execution& execution) {
  EmissionProblem problem;
  problem.unknowns = &unknowns;
  ranks.send(0, std::string(1, kReady));
  for (;;) {
    const RankMessage message = wait_for_message(ranks);
    RankReader reader(std::string_view(message.bytes).substr(1));
    try {
      std::string answer(1, kPiece);
      switch (message.bytes.front()) {
        case kDraw: {
          put(answer, reader.get<std::size_t>());
          const auto view = reader.get<std::size_t>();
          const auto window = reader.get<PixelWindow>();
          const auto box = reader.get<Box>();
          const auto settings = reader.get<CameraRaySettings>();
          put_rays(answer, draw_piece(views.at(view), view, window, box, settings, execution));
          ranks.send(0, std::move(answer));
          break;
        }
        case kModel:
          problem.model = reader.get<RowModel>();
          problem.absorption = reader.get_all<double>();
          break;
        case kRows: {
          put(answer, reader.get<std::size_t>());
          const CameraRays rays = get_rays(reader);
          problem.rays = &rays;
          const CsrRows<float> rows = make_emission_rows(problem, execution);
          put_all(answer, rows.counts);
          put_all(answer, rows.columns);
          put_all(answer, rows.values);
          ranks.send(0, std::move(answer));
          break;
        }
        case kEnds:
          return true;
        case rank_message::kQuit:
          return false;
        default:
          break;
      }
    } catch (const std::bad_alloc&) {
      ranks.send(0, rank_message::kFailed + std::string("a rank has not enough memory"));
    } catch (const Cancelled&) {
      ranks.send(0, rank_message::kFailed +
                        std::string("a rank was stopped; the same command begins anew"));
    } catch (const std::exception& error) {
      ranks.send(0, rank_message::kFailed + std::string(error.what()));
    }
  }
}

}  // namespace plenoflame
