#pragma once
#include <pybind11/pybind11.h>

#include <string>

#include "settings.h"

namespace plenoflame::python {

/// Adds rows as tuples: name, form, help, default, kind, repeated, required.
template <class Request>
void add_settings(pybind11::list& list) {
  for (const SettingRow<Request>& row : setting_rows<Request>()) {
    const SettingFacts facts = facts_of(row);
    list.append(pybind11::make_tuple(std::string(facts.name), std::string(facts.form), facts.help,
                                     facts.value, facts.kind, facts.repeated, facts.required));
  }
}

/// The rows of a request alone.
template <class Request>
pybind11::list settings_alone() {
  pybind11::list list;
  add_settings<Request>(list);
  return list;
}

}  // namespace plenoflame::python
