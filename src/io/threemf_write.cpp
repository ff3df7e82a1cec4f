// Writing 3MF: three files in a ZIP archive, of which 3D/3dmodel.model holds the objects.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <unordered_map>

#include "threemf.h"
#include "zip_archive.h"

namespace burnish {
namespace {

constexpr std::string_view kTypes =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>
)";
constexpr std::string_view kRelations =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>
)";
constexpr float kLargest = 1e9f;  // coordinate that readers take; lib3mf refuses more
constexpr int kMaterials = 1;     // id of the resource; objects follow

using FloatPoint = std::array<float, 3>;

struct PointHash {
  std::size_t operator()(const FloatPoint& p) const {
    std::array<std::uint32_t, 3> bits;
    std::memcpy(bits.data(), p.data(), sizeof bits);
    std::uint64_t h = 0;
    for (const std::uint32_t b : bits) h = (h ^ b) * 0x9e3779b97f4a7c15u;
    return static_cast<std::size_t>(h ^ h >> 32);
  }
};

struct Object {
  std::string name;
  std::vector<FloatPoint> points;  // all different
  std::vector<Facet> facets;       // of three different points
  std::vector<Color> colors;       // one a facet, or none
};

// Points that round to the same are one: a 3MF is joined where it shares points, and nowhere else.
class ObjectMaker {
 public:
  ObjectMaker(const TriangleSoup& soup, const std::string& label) : soup_(soup), label_(label) {}

  Object make(std::string name, std::size_t begin, std::size_t end) const {
    Object object{std::move(name), {}, {}, {}};
    std::unordered_map<FloatPoint, std::uint32_t, PointHash> numbers;
    for (std::size_t f = begin; f < end; ++f) {
      Facet facet;
      std::transform(soup_.facets[f].begin(), soup_.facets[f].end(), facet.begin(), [&](std::uint32_t p) {
        const FloatPoint point = rounded(soup_.points[p]);
        const auto [at, is_new] = numbers.emplace(point, static_cast<std::uint32_t>(numbers.size()));
        if (is_new) object.points.push_back(point);
        return at->second;
      });
      if (facet[0] == facet[1] || facet[1] == facet[2] || facet[2] == facet[0]) continue;
      object.facets.push_back(facet);
      if (!soup_.colors.empty()) object.colors.push_back(soup_.colors[f]);
    }
    return object;
  }

 private:
  FloatPoint rounded(const Vec3& p) const {
    FloatPoint r{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
    for (float& c : r) {
      c += 0.0f;  // -0 is 0
      if (!(std::abs(c) <= kLargest))
        throw Error(ErrorCode::unwritable_output, fmt::format("{}: the point ({}, {}, {}) is beyond the 1e9 that readers of 3MF take", label_, p.x, p.y, p.z), "write .ply, .obj or .off, or scale the model");
    }
    return r;
  }

  const TriangleSoup& soup_;
  const std::string& label_;
};

// Whether every edge is there as often one way as the other.
bool is_closed(const Object& object) {
  std::vector<std::uint64_t> ways;
  for (const Facet& f : object.facets)
    for (std::size_t i = 0; i < 3; ++i) ways.push_back(std::uint64_t{f[i]} << 32 | f[(i + 1) % 3]);
  std::vector<std::uint64_t> back(ways.size());
  std::transform(ways.begin(), ways.end(), back.begin(), [](std::uint64_t w) { return w << 32 | w >> 32; });
  std::sort(ways.begin(), ways.end());
  std::sort(back.begin(), back.end());
  return ways == back;
}

std::vector<Object> objects_of(const TriangleSoup& soup, const std::string& label) {
  const ObjectMaker maker(soup, label);
  std::vector<Object> objects;
  for (const FacetGroup& g : soup.groups) objects.push_back(maker.make(g.name, g.first_facet, g.first_facet + g.facet_count));
  std::erase_if(objects, [](const Object& o) { return o.facets.empty(); });
  if (objects.size() > 1 && !std::all_of(objects.begin(), objects.end(), is_closed)) objects.clear();
  if (objects.empty()) objects.push_back(maker.make(soup.groups.size() == 1 ? soup.groups[0].name : "", 0, soup.facets.size()));
  if (objects[0].facets.empty()) throw Error(ErrorCode::unwritable_output, label + ": no facet is left when coordinates are rounded to float32", "write .ply, or scale the model");
  return objects;
}

// Bytes of a character of UTF-8 that XML may hold at `at`; 0 if there is none.
std::size_t character(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
  const unsigned first = byte(at);
  if (first < 0x80) return first >= 0x20 && first != 0x7f ? 1 : 0;
  const std::size_t length = first >= 0xc2 && first < 0xe0 ? 2 : first >= 0xe0 && first < 0xf0 ? 3 : first >= 0xf0 && first < 0xf5 ? 4 : 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(at + i) & 0xc0) != 0x80) return 0;
  const unsigned second = byte(at + 1);
  const bool is_bad = (first == 0xe0 && second < 0xa0) || (first == 0xed && second >= 0xa0) || (first == 0xf0 && second < 0x90) || (first == 0xf4 && second >= 0x90) ||
                      (first == 0xef && second == 0xbf && byte(at + 2) >= 0xbe);
  return is_bad ? 0 : length;
}

std::string escaped(std::string_view text) {
  std::string xml;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = character(text, i);
    const char c = text[i];
    if (length == 0)
      xml += c == '\t' || c == '\n' || c == '\r' ? " " : "\xef\xbf\xbd";
    else if (length > 1)
      xml += text.substr(i, length);
    else
      xml += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '"' ? "&quot;" : std::string(1, c);
    i += std::max<std::size_t>(length, 1);
  }
  return xml;
}

// As 3MF spells it.
std::string_view spelled(ModelUnit unit) {
  constexpr std::array<std::string_view, kModelUnits.size()> kNames{"millimeter", "centimeter", "meter", "inch", "micron", "foot"};
  return kNames[static_cast<std::size_t>(unit)];
}

class ModelPart {
 public:
  explicit ModelPart(ModelUnit unit) : member_("3D/3dmodel.model") {
    member_.put(fmt::format("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"{}\" xml:lang=\"en-US\" xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n", spelled(unit)));
    member_.put("<metadata name=\"Application\">burnish</metadata>\n<resources>\n");
  }

  // The colours of all objects. The first is the default that a specification of properties asks for: of facets without a colour, and told by its name.
  void put_materials(const std::vector<Color>& colors) {
    if (std::all_of(colors.begin(), colors.end(), [](Color c) { return c == kNoColor; })) return;
    std::vector<Color> all(colors);
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    std::erase(all, kNoColor);
    all.insert(all.begin(), kNoColor);
    member_.put(fmt::format("<basematerials id=\"{}\">\n", kMaterials));
    for (const Color c : all) {
      material_.emplace(c, material_.size());
      const std::string hex = fmt::format("#{:02X}{:02X}{:02X}{:02X}", channel(c, 0), channel(c, 1), channel(c, 2), channel(c, 3));
      const bool none = c == kNoColor;
      member_.put(fmt::format("<base name=\"{}\" displaycolor=\"{}\"/>\n", none ? kUncoloured : std::string_view(hex), none ? "#B4B4B4FF" : std::string_view(hex)));
    }
    member_.put("</basematerials>\n");
  }

  void put_object(std::size_t id, const Object& object) {
    const std::string named = object.name.empty() ? "" : fmt::format(" name=\"{}\"", escaped(object.name));
    member_.put(fmt::format("<object id=\"{}\" type=\"model\"{}{}>\n<mesh>\n<vertices>\n", id, named, material_.empty() ? "" : fmt::format(" pid=\"{}\" pindex=\"0\"", kMaterials)));
    for (const FloatPoint& p : object.points) put_point(p);
    member_.put("</vertices>\n<triangles>\n");
    for (std::size_t f = 0; f < object.facets.size(); ++f) put_facet(object, f);
    member_.put("</triangles>\n</mesh>\n</object>\n");
  }

  const ZipMember& finish(std::size_t objects) {
    member_.put("</resources>\n<build>\n");
    for (std::size_t i = 0; i < objects; ++i) member_.put(fmt::format("<item objectid=\"{}\"/>\n", kMaterials + 1 + i));
    member_.put("</build>\n</model>\n");
    member_.finish();
    return member_;
  }

 private:
  // With the digits of a double: readers in single and in double precision then see the same point.
  void put_point(const FloatPoint& p) {
    std::array<char, 128> line;
    char* at = line.data();
    const auto text = [&](std::string_view t) { at = std::copy(t.begin(), t.end(), at); };
    text("<vertex");
    for (std::size_t a = 0; a < 3; ++a) {
      text(std::array<std::string_view, 3>{" x=\"", "\" y=\"", "\" z=\""}[a]);
      at = std::to_chars(at, line.data() + line.size(), static_cast<double>(p[a])).ptr;
    }
    text("\"/>\n");
    member_.put({line.data(), static_cast<std::size_t>(at - line.data())});
  }

  void put_facet(const Object& object, std::size_t f) {
    const Facet& c = object.facets[f];
    const std::string material = object.colors.empty() || object.colors[f] == kNoColor ? "" : fmt::format(" pid=\"{}\" p1=\"{}\"", kMaterials, material_.at(object.colors[f]));
    member_.put(fmt::format("<triangle v1=\"{}\" v2=\"{}\" v3=\"{}\"{}/>\n", c[0], c[1], c[2], material));
  }

  ZipMember member_;
  std::unordered_map<Color, std::size_t> material_;
};

}  // namespace

void write_3mf(FdWriter& out, const std::string& label, const TriangleSoup& soup, const MeshWriteOptions& options) {
  const std::vector<Object> objects = objects_of(soup, label);
  ModelPart model(options.unit);
  model.put_materials(soup.colors);
  for (std::size_t i = 0; i < objects.size(); ++i) model.put_object(kMaterials + 1 + i, objects[i]);
  ZipMember types("[Content_Types].xml"), relations("_rels/.rels");
  types.put(kTypes);
  relations.put(kRelations);
  types.finish();
  relations.finish();
  write_zip(out, label, {&types, &relations, &model.finish(objects.size())});
}

}  // namespace burnish
