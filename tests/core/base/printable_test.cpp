// The expected texts are written out by hand from the tables of Unicode and of UTF-8 (RFC 3629).
#include "plenoflame/base/printable.h"

#include <gtest/gtest.h>

namespace plenoflame::printable_test {
namespace {

TEST(Printable, LeavesTextAlone) {
  EXPECT_EQ(printable(""), "");
  EXPECT_EQ(printable("flame \"a\\b\" 5 \xc2\xb5W"), "flame \"a\\b\" 5 \xc2\xb5W");
  EXPECT_EQ(printable("\xe7\x84\x94 \xf0\x9f\x94\xa5"), "\xe7\x84\x94 \xf0\x9f\x94\xa5");
}

TEST(Printable, EscapesWhatATerminalActsOn) {
  EXPECT_EQ(printable("a\x1b[31mred\r\n"), "a\\u001b[31mred\\u000d\\u000a");
  EXPECT_EQ(printable(std::string_view("\0\t\x7f", 3)), "\\u0000\\u0009\\u007f");
  EXPECT_EQ(printable("\xc2\x9b"
                      "2J"),
            "\\u009b2J");  // C1: CSI in one character
  EXPECT_EQ(printable("\xe2\x80\xae"
                      "gpj"),
            "\\u202egpj");                                             // right to left
  EXPECT_EQ(printable("\xe2\x80\xa8\xe2\x81\xa6"), "\\u2028\\u2066");  // line, isolate
}

TEST(Printable, EscapesWhatIsNotUtf8) {
  EXPECT_EQ(printable("caf\xe9"), "caf\\xe9");
  EXPECT_EQ(printable("\xc0\x9b"), "\\xc0\\x9b");                    // longer than need be
  EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80");           // half of a pair of UTF-16
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");  // beyond U+10FFFF
  EXPECT_EQ(printable("a\xe2\x80"), "a\\xe2\\x80");                  // cut off
}

TEST(Printable, KeepsLinesWhenAsked) {
  EXPECT_EQ(printable("a\n\tb\r\nc\rd\x1b", true), "a\n\tb\r\nc\\u000dd\\u001b");
}

}  // namespace
}  // namespace plenoflame::printable_test
