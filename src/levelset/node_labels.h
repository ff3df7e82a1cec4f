// Components of the equal-signed nodes within a leaf, by rows of eight nodes as bits.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "burnish/octree/field.h"

namespace burnish::detail {

inline constexpr std::size_t kBlockRows = std::size_t{kBlockSide} * kBlockSide;
constexpr std::size_t row_index(int j, int k) { return static_cast<std::size_t>(j + kBlockSide * k); }

// A bit per node (or per cell above it), a byte per row.
using RowBits = std::array<std::uint8_t, kBlockRows>;

// A row of nodes: which are inside, and where runs of one label start.
struct NodeRow {
  unsigned inside, starts;
};

// The edges of Kuhn cells between a row and one below it (in y, z or both), between nodes of one side: visit(node, node below) for at least one edge of
// every two runs that some join. `plain`: the cells above the lower row's nodes that are Kuhn cells.
template <class Visit>
void for_joined_runs(NodeRow upper, NodeRow lower, unsigned plain, Visit&& visit) {
  const unsigned straight = ~(upper.inside ^ lower.inside) & plain & 0xffu;
  const unsigned slanted = ~(upper.inside ^ lower.inside << 1) & plain << 1 & 0xfeu;  // to the node before
  for (unsigned rest = straight & (upper.starts | lower.starts | ~(straight << 1)); rest != 0; rest &= rest - 1) {
    const int i = std::countr_zero(rest);
    visit(i, i);
  }
  const unsigned told = (straight << 1 & ~upper.starts) | (straight & ~lower.starts) | (slanted << 1 & ~(upper.starts | lower.starts << 1));
  for (unsigned rest = slanted & ~told; rest != 0; rest &= rest - 1) {
    const int i = std::countr_zero(rest);
    visit(i, i - 1);
  }
}

// Components of the equal-signed nodes of a leaf, joined by edges of Kuhn cells within it. Numbers start at 0. Made by a Labeller.
struct Labels {
  RowBits inside, starts;
  std::array<std::uint16_t, kBlockNodes> of;
  std::uint32_t count;

  NodeRow row(std::size_t r) const { return {inside[r], starts[r]}; }
};

class Labeller {
 public:
  // `plain`: the leaf's cells that are Kuhn cells.
  template <class T>
  Labeller(const T* phi, const RowBits& plain, Labels& labels) : labels_(labels) {
    for (std::size_t r = 0; r < kBlockRows; ++r) {
      unsigned inside = 0;
      for (std::size_t i = 0; i < kBlockSide; ++i) inside |= static_cast<unsigned>(phi[r * kBlockSide + i] >= 0) << i;
      labels.inside[r] = static_cast<std::uint8_t>(inside);
      label_runs(r, plain[r]);
    }
    for (int k = 0; k < kBlockSide; ++k)
      for (int j = 0; j < kBlockSide; ++j)
        for (int lower = 1; lower < 4; ++lower) {
          const int dy = lower & 1, dz = lower >> 1;
          if (j >= dy && k >= dz) unite_rows(row_index(j, k), row_index(j - dy, k - dz), plain);
        }
    number();
  }

 private:
  void label_runs(std::size_t r, unsigned plain) {
    const unsigned inside = labels_.inside[r];
    const unsigned starts = (((inside ^ inside << 1) | ~(plain << 1)) & 0xffu) | 1u;
    labels_.starts[r] = static_cast<std::uint8_t>(starts);
    for (int i = 0; i < kBlockSide; ++i) {
      if (starts >> i & 1) parent_[used_] = used_, ++used_;
      labels_.of[r * kBlockSide + static_cast<std::size_t>(i)] = static_cast<std::uint16_t>(used_ - 1);
    }
  }
  void unite_rows(std::size_t r, std::size_t below, const RowBits& plain) {
    for_joined_runs(labels_.row(r), labels_.row(below), plain[below], [&](int i, int j) {
      const std::uint16_t a = find(labels_.of[r * kBlockSide + static_cast<std::size_t>(i)]);
      const std::uint16_t b = find(labels_.of[below * kBlockSide + static_cast<std::size_t>(j)]);
      parent_[std::max(a, b)] = std::min(a, b);
    });
  }
  std::uint16_t find(std::uint16_t l) const {
    while (parent_[l] != l) l = parent_[l];
    return l;
  }
  void number() {
    labels_.count = 0;
    std::array<std::uint16_t, kBlockNodes> number;
    for (std::uint16_t l = 0; l < used_; ++l)
      number[l] = parent_[l] == l ? static_cast<std::uint16_t>(labels_.count++) : number[find(l)];
    for (std::uint16_t& l : labels_.of) l = number[l];
  }

  Labels& labels_;
  std::array<std::uint16_t, kBlockNodes> parent_;
  std::uint16_t used_ = 0;
};

}  // namespace burnish::detail
