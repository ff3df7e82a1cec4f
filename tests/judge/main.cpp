// burnish_judge INPUT.stl OUTPUT.stl [--samples N] [--cell C]
//
// Judges the result of a repair without a line of the program that made it, and prints one JSON object: what
// holds of OUTPUT after welding by exact coordinates, and the distances between the two, both ways. Exit code
// 0 whenever it could judge, however bad the output; 1 when OUTPUT cannot be read; 2 for a wrong call.
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include "geometry.h"
#include "stl.h"
#include "topology.h"

namespace {

struct Call {
  std::string input, output;
  std::size_t samples = 20000;
  double cell = 0;  // 0: not given
};

template <class Number>
bool parse(const std::string& text, Number& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && value > 0;
}

bool parse(int count, char** words, Call& call) {
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i], next = i + 1 < count ? words[i + 1] : "";
    if (word == "--samples" || word == "--cell") {
      if (!(word == "--cell" ? parse(next, call.cell) : parse(next, call.samples))) return false;
      ++i;
    } else if (call.input.empty()) {
      call.input = word;
    } else if (call.output.empty()) {
      call.output = word;
    } else {
      return false;
    }
  }
  return !call.output.empty();
}

// A JSON object as it grows; the names are ours and need no escapes.
class Object {
 public:
  void add(const char* name, const std::string& value) {
    text_ += std::string(text_.empty() ? "" : ", ") + '"' + name + "\": " + value;
  }
  void add(const char* name, bool value) { add(name, std::string(value ? "true" : "false")); }
  void add(const char* name, std::size_t value) { add(name, std::to_string(value)); }
  void add(const char* name, double value) {
    char text[64];
    std::snprintf(text, sizeof text, "%.17g", value);
    add(name, std::string(std::isfinite(value) ? text : "null"));
  }
  std::string text() const { return '{' + text_ + '}'; }

 private:
  std::string text_;
};

void add_mesh(Object& object, const judge::Mesh& mesh, const judge::Topology& topology) {
  if (!mesh.error.empty()) object.add("error", '"' + mesh.error + '"');
  object.add("facets", mesh.facets.size());
  object.add("facets_left_out", mesh.left_out);
  object.add("points", mesh.points.size());
  object.add("components", topology.components);
  object.add("area", judge::area(mesh));
  object.add("diagonal", judge::diagonal(mesh));
}

void add_verdict(Object& object, const judge::Mesh& mesh, const judge::Topology& topology) {
  const bool manifold = topology.manifold() && !mesh.facets.empty() && mesh.left_out == 0;
  const bool closed = topology.closed() && !mesh.facets.empty(), oriented = topology.oriented();
  const auto embedding = judge::inspect_embedding(mesh, manifold, closed, oriented);
  const bool tame = manifold && oriented && embedding.self_intersections == std::size_t{0};
  const double volume = judge::signed_volume(mesh);
  object.add("closed", closed);
  object.add("two_manifold", manifold && closed);
  object.add("oriented", oriented);
  if (embedding.self_intersections)
    object.add("self_intersections", *embedding.self_intersections);
  else
    object.add("self_intersections", std::string("null"));
  object.add("bounds_volume", embedding.bounds_volume);
  object.add("volume", volume);
  object.add("valid", closed && tame && embedding.bounds_volume && volume > 0);
  object.add("valid_sheet", !closed && tame);
  object.add("open_edges", topology.open_edges);
  object.add("open_loops", topology.open_loops);
  object.add("non_manifold_edges", topology.non_manifold_edges);
  object.add("non_manifold_points", topology.non_manifold_points);
  object.add("misoriented_edges", topology.misoriented_edges);
  object.add("repeating_facets", topology.repeating_facets);
}

// Percents are of the input's diagonal in both directions.
Object distances_object(const judge::Distances& distances, double diagonal, double cell) {
  const double none = std::numeric_limits<double>::quiet_NaN(), percent = 100 / diagonal;
  const bool measured = distances.samples > 0;
  Object object;
  object.add("samples", distances.samples);
  object.add("rms", measured ? distances.rms : none);
  object.add("max", measured ? distances.max : none);
  object.add("rms_percent", measured ? distances.rms * percent : none);
  object.add("max_percent", measured ? distances.max * percent : none);
  object.add("far_share", measured && cell > 0 ? distances.far_share : none);
  return object;
}

}  // namespace

int main(int count, char** words) {
  Call call;
  if (!parse(count, words, call)) {
    std::fputs("usage: burnish_judge INPUT.stl OUTPUT.stl [--samples N] [--cell C]\n", stderr);
    return 2;
  }
  const judge::Mesh input = judge::read_stl(call.input), output = judge::read_stl(call.output);
  if (!output.error.empty()) {
    std::fprintf(stderr, "burnish_judge: %s: %s\n", call.output.c_str(), output.error.c_str());
    return 1;
  }
  Object before, after, all;
  add_mesh(before, input, judge::count_topology(input));
  const judge::Topology topology = judge::count_topology(output);
  add_mesh(after, output, topology);
  add_verdict(after, output, topology);
  const double far = call.cell > 0 ? 1.5 * call.cell : std::numeric_limits<double>::infinity();
  const double diagonal = judge::diagonal(input);
  const auto there = judge::measure(input, output, call.samples, far);
  const auto back = judge::measure(output, input, call.samples, far);
  all.add("input", before.text());
  all.add("output", after.text());
  all.add("input_to_output", distances_object(there, diagonal, call.cell).text());
  all.add("output_to_input", distances_object(back, diagonal, call.cell).text());
  std::puts(all.text().c_str());
  return 0;
}
