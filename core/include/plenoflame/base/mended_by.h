#pragma once
#include <string>
#include <utility>
#include <vector>

/// Errors that name what mends them.
namespace plenoflame {

/// Part of an error: names of settings that mend it, "region". A front end says how it calls them.
struct MendedBy {
  std::vector<std::string> names;
};

/// An error of some kind with such names.
template <class Kind>
class MendedError final : public Kind, public MendedBy {
 public:
  MendedError(const Kind& error, std::vector<std::string> settings)
      : Kind(error), MendedBy{std::move(settings)} {}
};

template <class Kind>
MendedError<Kind> mended_by(const Kind& error, std::vector<std::string> settings) {
  return {error, std::move(settings)};
}

}  // namespace plenoflame
