#pragma once
#include <cstddef>
#include <string>

#include "plenoflame/base/report.h"

namespace plenoflame {

/// Columns of the terminal that standard output goes to; 0: it goes elsewhere.
std::size_t output_columns();

/// Appends a line to `text`, broken between words where it is wider than `width`. Runs of blanks
/// stay as they are: columns of a list.
/// @param used column at which the line begins @param begin those that follow begin there
void append_wrapped(std::string& text, const std::string& line, std::size_t used, std::size_t begin,
                    std::size_t width);

/// The lines of a text, broken between words where the terminal of standard output wants it.
std::string fitting(const std::string& text);

/// Prints a report to standard output, as aligned lines or as JSON. On a terminal the lines are
/// broken between words.
void print(const Report& report, bool as_json);

}  // namespace plenoflame
