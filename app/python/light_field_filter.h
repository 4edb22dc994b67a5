#pragma once
#include <memory>
#include <string>

#include "plenoflame/image/light_field.h"
#include "runnable.h"

namespace plenoflame::python {

using Field = std::shared_ptr<LightField>;

/// Makes something of one light field.
class Filter : public Runnable {
 public:
  Field input;
  std::string channel;
};

}  // namespace plenoflame::python
