// Colours of a binary STL. The format has none; two conventions put them into the 16 bits of attributes, five
// bits a channel, and contradict each other.
//
//              facet has a colour of its own   bits 0-4, 5-9, 10-14   otherwise
//   Magics     bit 15 is 0                     red, green, blue       the part's: COLOR= and four bytes in
//   the header VisCAM     bit 15 is 1                     blue, green, red       no colour
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "burnish/surface/triangle_soup.h"

namespace burnish {

// True if the 80 bytes of a header hold COLOR= and its four bytes.
bool has_part_color(std::string_view header);

// What a header says to people: up to the first NUL or COLOR=, without blanks at its end.
std::string stl_header_text(std::string_view header);

// The colours of facets with these attributes, or nothing where they are no colours. Magics is what a header
// with COLOR= says; attributes that are all zero were left unset then, and every facet has the part's colour.
// Without, attributes are taken for VisCAM's only when each either has bit 15 or is zero, and they are not
// one value of two equal bytes throughout: memory and numbers that other programs leave there do not pass.
std::vector<Color> colors_of_attributes(std::string_view header, std::span<const std::uint16_t> attributes);

// How a soup's colours are written: by Magics when every facet has one; the most frequent is the part's then
// and keeps all its bits. By VisCAM, which can leave facets without, otherwise. Other colours are rounded to
// five bits a channel.
class ColorAttributes {
 public:
  explicit ColorAttributes(std::span<const Color> colors);

  // What follows the text of the header, "" for VisCAM.
  std::string header_suffix() const;
  std::uint16_t operator()(Color color) const;

 private:
  Color part_ = kNoColor;  // kNoColor: VisCAM
};

}  // namespace burnish
