#include "plenoflame/base/part.h"

#include <charconv>
#include <cmath>

#include "plenoflame/base/error.h"

namespace plenoflame {
namespace {

bool read_number(const char*& at, const char* end, int& number) {
  const auto [next, error] = std::from_chars(at, end, number);
  if (error != std::errc() || next == at || *at == '-') return false;
  at = next;
  return true;
}

}  // namespace

std::string to_string(const Part& part) {
  return std::to_string(part.number) + "/" + std::to_string(part.count);
}

Part part_from(const std::string& text) {
  Part part;
  const char* at = text.data();
  const char* const end = at + text.size();
  const bool read = read_number(at, end, part.number) && at != end && *at++ == '/' &&
                    read_number(at, end, part.count) && at == end;
  if (!read || part.count < 1 || part.count > kMostParts || part.number < 1 ||
      part.number > part.count)
    throw UsageError("'" + text + "' is no part such as 2/4: the second of four, from 1/4 to 4/4");
  return part;
}

int part_of_tile(int tile, int across, int parts) {
  // The points of a rank-1 lattice whose step is the golden section of `parts`. Each row is rotated
  // against the previous one, so that no part owns a whole column.
  const long long row = tile / across, column = tile % across;
  const auto golden = static_cast<long long>(std::lround(0.6180339887498949 * parts));
  const long long step = (golden - across % parts + parts) % parts;
  return static_cast<int>((row * across + (column + row * step) % across) % parts);
}

}  // namespace plenoflame
