// Reading 3MF with lib3mf: the build's items, with components and transforms. The library's header is for this source alone.
#include <Common/NMR_ErrorConst.h>
#include <Model/COM/NMR_DLLInterfaces.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <set>
#include <string>
#include <unordered_map>

#include "counts.h"
#include "readers.h"
#include "threemf.h"
#include "threemf_components.h"
#include "zip_archive.h"

namespace burnish {
namespace {

constexpr std::uint64_t kLargestRatio = 200, kAlwaysAllowed = std::uint64_t{64} << 20, kNeverAllowed = std::uint64_t{8} << 30;
constexpr std::size_t kMostInstanced = std::size_t{1} << 26;  // facets
constexpr std::uint64_t kMostPlaced = 1'000'000;              // objects
constexpr int kDeepest = 64;                                  // components in components
constexpr std::size_t kMostMessages = 3;                      // of the library's warnings
constexpr std::string_view kHint = "export the model again, or as STL";

struct Release {
  void operator()(void* instance) const { NMR::lib3mf_release(static_cast<NMR::PLib3MFBase*>(instance)); }
};
template <class T>
using Handle = std::unique_ptr<T, Release>;

// p -> rows . (p, 1)
struct Transform {
  std::array<std::array<double, 4>, 3> rows{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

  Vec3 operator()(const Vec3& p) const {
    Vec3 q;
    for (int i = 0; i < 3; ++i) {
      const auto& r = rows[static_cast<std::size_t>(i)];
      q[i] = r[0] * p.x + r[1] * p.y + r[2] * p.z + r[3];
    }
    return q;
  }
  bool mirrors() const {
    const auto column = [&](std::size_t c) { return Vec3{rows[0][c], rows[1][c], rows[2][c]}; };
    return dot(cross(column(0), column(1)), column(2)) < 0;
  }
};

// `inner` first.
Transform operator*(const Transform& outer, const Transform& inner) {
  Transform product;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 4; ++j) {
      product.rows[i][j] = j == 3 ? outer.rows[i][3] : 0;
      for (std::size_t k = 0; k < 3; ++k) product.rows[i][j] += outer.rows[i][k] * inner.rows[k][j];
    }
  return product;
}

Transform transform_of(const NMR::MODELTRANSFORM& matrix) {
  Transform t;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 4; ++j) t.rows[i][j] = static_cast<double>(matrix.m_fFields[i][j]);
  return t;
}

struct Mesh {
  std::vector<Vec3> points;
  std::vector<Facet> facets;
  std::vector<Color> colors;  // empty: none
};

struct Component {
  std::uint32_t object;
  Transform transform;
};

struct Object {
  std::string name;
  DWORD type = NMR::MODELOBJECTTYPE_MODEL;
  bool is_mesh = false;
  Mesh mesh;
  std::vector<Component> components;
  std::size_t facets = 0;  // with those of all components, each as often as it is there
  int depth = 0;           // of components below
};

class Reader {
 public:
  explicit Reader(const Source& source) : source_(source) {}

  MeshFile read() {
    load();
    file_.format = MeshFormat::threemf;
    read_unit();
    Handle<NMR::PLib3MFModelBuildItemIterator> items;
    ask([&](auto** out) { return NMR::lib3mf_model_getbuilditems(model_.get(), out); }, items);
    BOOL more = 0;
    while (check(NMR::lib3mf_builditemiterator_movenext(items.get(), &more), items.get()), more) {
      Handle<NMR::PLib3MFModelBuildItem> item;
      ask([&](auto** out) { return NMR::lib3mf_builditemiterator_getcurrent(items.get(), out); }, item);
      add_item(item.get());
    }
    finish();
    return std::move(file_);
  }

 private:
  [[noreturn]] void fail_of(void* instance) {
    DWORD code = 0;
    LPCSTR text = nullptr;
    if (instance) NMR::lib3mf_getlasterror(static_cast<NMR::PLib3MFBase*>(instance), &code, &text);
    source_.fail(fmt::format("cannot be read as 3MF: {} (lib3mf, 0x{:04x})", text && *text ? text : "unknown reason", code), kHint);
  }
  template <class T>
  void check(LIB3MFRESULT status, T* instance) {
    if (status != LIB3MF_OK) fail_of(instance);
  }
  template <class T, class Call>
  void ask(Call&& call, Handle<T>& handle) {
    T* instance = nullptr;
    if (call(&instance) != LIB3MF_OK || !instance) fail_of(model_.get());
    handle.reset(instance);
  }

  void load() {
    NMR::PLib3MFModel* model = nullptr;
    if (NMR::lib3mf_createmodel(&model) != LIB3MF_OK) throw std::bad_alloc();
    model_.reset(model);
    Handle<NMR::PLib3MFModelReader> reader;
    ask([&](auto** out) { return NMR::lib3mf_model_queryreader(model, "3mf", out); }, reader);
    auto* bytes = reinterpret_cast<BYTE*>(const_cast<char*>(source_.bytes.data()));
    check(NMR::lib3mf_reader_readfrombuffer(reader.get(), bytes, source_.bytes.size()), reader.get());
    tell_warnings(reader.get());
  }

  void tell_warnings(NMR::PLib3MFModelReader* reader) {
    DWORD count = 0;
    NMR::lib3mf_reader_getwarningcount(reader, &count);
    std::set<std::string> told;
    for (DWORD i = 0; i < count && told.size() < kMostMessages; ++i) {
      DWORD code = 0;
      ULONG needed = 0;
      std::array<char, 1024> text{};
      if (NMR::lib3mf_reader_getwarningutf8(reader, i, &code, text.data(), text.size(), &needed) != LIB3MF_OK) continue;
      if (code == NMR_ERROR_REQUIREDEXTENSIONNOTSUPPORTED && !source_.salvage)
        source_.fail("needs an extension of 3MF that is not known here: what it holds may be incomplete without", "export it without extensions, or pass --salvage to use what is there");
      if (told.insert(text.data()).second) file_.warnings.push_back(fmt::format("{} (lib3mf, 0x{:04x})", text.data(), code));
    }
  }

  void read_unit() {
    constexpr std::array<ModelUnit, 6> kUnits{ModelUnit::micrometre, ModelUnit::millimetre, ModelUnit::centimetre, ModelUnit::inch, ModelUnit::foot, ModelUnit::metre};
    DWORD unit = NMR::MODELUNIT_MILLIMETER;
    check(NMR::lib3mf_model_getunit(model_.get(), &unit), model_.get());
    if (unit < kUnits.size()) file_.unit = kUnits[unit];
  }

  void add_item(NMR::PLib3MFModelBuildItem* item) {
    Handle<NMR::PLib3MFModelObjectResource> resource;
    ask([&](auto** out) { return NMR::lib3mf_builditem_getobjectresource(item, out); }, resource);
    NMR::MODELTRANSFORM matrix;
    check(NMR::lib3mf_builditem_getobjecttransform(item, &matrix), item);
    const std::uint32_t id = load_object(resource.get(), 0);
    instanced_ += objects_.at(id).facets;
    if (instanced_ > std::max(kMostInstanced, distinct_))
      source_.fail(fmt::format("places more than {} facets: components refer to each other too often", kMostInstanced), kHint);
    place(id, transform_of(matrix), objects_.at(id).name);
  }

  std::uint32_t load_object(NMR::PLib3MFModelObjectResource* resource, int depth) {
    DWORD id = 0;
    check(NMR::lib3mf_resource_getresourceid(resource, &id), resource);
    if (depth > kDeepest) source_.fail(fmt::format("has components in components more than {} deep", kDeepest), kHint);
    if (objects_.contains(id)) {
      if (depth + objects_.at(id).depth > kDeepest) source_.fail(fmt::format("has components in components more than {} deep", kDeepest), kHint);
      return id;
    }
    Object object;
    object.name = name_of(resource);
    check(NMR::lib3mf_object_gettype(resource, &object.type), resource);
    BOOL is_mesh = 0;
    check(NMR::lib3mf_object_ismeshobject(resource, &is_mesh), resource);
    object.is_mesh = is_mesh != 0;
    if (object.type != NMR::MODELOBJECTTYPE_MODEL)
      add_left_out(object.type);  // with all that it is composed of
    else if (is_mesh)
      load_mesh(resource, object);
    else
      load_components(resource, object, depth);
    objects_.emplace(id, std::move(object));
    return id;
  }

  std::string name_of(NMR::PLib3MFModelObjectResource* resource) {
    ULONG size = 0;
    if (NMR::lib3mf_object_getnameutf8(resource, nullptr, 0, &size) != LIB3MF_OK || size == 0 || size > source_.bytes.size() * kLargestRatio + kAlwaysAllowed) return {};
    std::string name(size + 1, '\0');
    if (NMR::lib3mf_object_getnameutf8(resource, name.data(), static_cast<ULONG>(name.size()), &size) != LIB3MF_OK) return {};
    name.resize(std::min(name.find('\0'), name.size()));
    return name;
  }

  void load_components(NMR::PLib3MFModelObjectResource* resource, Object& object, int depth) {
    DWORD count = 0;
    check(NMR::lib3mf_componentsobject_getcomponentcount(resource, &count), resource);
    for (DWORD i = 0; i < count; ++i) {
      Handle<NMR::PLib3MFModelComponent> component;
      ask([&](auto** out) { return NMR::lib3mf_componentsobject_getcomponent(resource, i, out); }, component);
      Handle<NMR::PLib3MFModelObjectResource> child;
      ask([&](auto** out) { return NMR::lib3mf_component_getobjectresource(component.get(), out); }, child);
      NMR::MODELTRANSFORM matrix;
      check(NMR::lib3mf_component_gettransform(component.get(), &matrix), component.get());
      const std::uint32_t id = load_object(child.get(), depth + 1);
      const Object& part = objects_.at(id);
      if (part.facets == 0) continue;  // or a few lines could ask for endless work
      object.components.push_back({id, transform_of(matrix)});
      object.depth = std::max(object.depth, part.depth + 1);
      object.facets = std::min(object.facets + part.facets, ~std::uint32_t{0} + std::size_t{1});
    }
  }

  void load_mesh(NMR::PLib3MFModelObjectResource* mesh, Object& object) {
    DWORD points = 0, facets = 0;
    check(NMR::lib3mf_meshobject_getvertexcount(mesh, &points), mesh);
    check(NMR::lib3mf_meshobject_gettrianglecount(mesh, &facets), mesh);
    if (facets == 0) return;
    std::vector<NMR::MODELMESHVERTEX> vertices(points);
    std::vector<NMR::MODELMESHTRIANGLE> triangles(facets);
    check(NMR::lib3mf_meshobject_getvertices(mesh, vertices.data(), points, nullptr), mesh);
    check(NMR::lib3mf_meshobject_gettriangleindices(mesh, triangles.data(), facets, nullptr), mesh);
    for (const auto& v : vertices) object.mesh.points.push_back({v.m_fPosition[0], v.m_fPosition[1], v.m_fPosition[2]});
    for (const auto& t : triangles) {
      object.mesh.facets.push_back({t.m_nIndices[0], t.m_nIndices[1], t.m_nIndices[2]});
      for (const std::uint32_t c : object.mesh.facets.back())
        if (c >= points) source_.fail(fmt::format("has a triangle with the point {} of a mesh that has {}", c, points), kHint);
    }
    drop_unused_points(object.mesh);  // or a few lines could ask for endless memory
    object.facets = facets;
    distinct_ += facets;
    load_colors(mesh, object.mesh);
  }

  static void drop_unused_points(Mesh& mesh) {
    if (mesh.points.size() <= 3 * mesh.facets.size()) return;
    std::unordered_map<std::uint32_t, std::uint32_t> place;
    std::vector<Vec3> used;
    for (Facet& f : mesh.facets)
      for (std::uint32_t& corner : f) {
        const auto [at, is_new] = place.emplace(corner, static_cast<std::uint32_t>(used.size()));
        if (is_new) used.push_back(mesh.points[corner]);
        corner = at->second;
      }
    mesh.points = std::move(used);
  }

  void add_left_out(DWORD type) {
    constexpr std::array<const char*, 5> kTypes{"other", "model", "support", "solidsupport", "surface"};
    const std::string what = type < kTypes.size() ? kTypes[type] : "unknown";
    if (left_out_.insert(what).second) file_.warnings.push_back(fmt::format("objects of type '{}' left out: only 'model' is the part itself", what));
  }

  void load_colors(NMR::PLib3MFModelMeshObject* mesh, Mesh& result) {
    Handle<NMR::PLib3MFPropertyHandler> handler;
    ask([&](auto** out) { return NMR::lib3mf_meshobject_createpropertyhandler(mesh, out); }, handler);
    const Color general = default_color(mesh);
    std::vector<Color> colors(result.facets.size(), general);
    for (DWORD f = 0; f < colors.size(); ++f) {
      NMR::eModelPropertyType type = NMR::MODELPROPERTYTYPE_NONE;
      if (NMR::lib3mf_propertyhandler_getpropertytype(handler.get(), f, &type) != LIB3MF_OK) continue;
      if (type == NMR::MODELPROPERTYTYPE_BASEMATERIALS) {
        DWORD group = 0, index = 0;
        if (NMR::lib3mf_propertyhandler_getbasematerial(handler.get(), f, &group, &index) == LIB3MF_OK) colors[f] = material_color(group, index);
      } else if (type == NMR::MODELPROPERTYTYPE_COLOR) {
        colors[f] = facet_color(handler.get(), f);
      } else if (type != NMR::MODELPROPERTYTYPE_NONE) {
        warn_once("textures and mixed materials are left out");
      }
    }
    if (std::any_of(colors.begin(), colors.end(), [](Color c) { return c != kNoColor; })) result.colors = std::move(colors);
  }

  static Color color(const NMR::MODELMESHCOLOR_SRGB& c) { return color_of(c.m_Red, c.m_Green, c.m_Blue, c.m_Alpha); }

  Color facet_color(NMR::PLib3MFPropertyHandler* handler, DWORD f) {
    NMR::MODELMESH_TRIANGLECOLOR_SRGB corners;
    if (NMR::lib3mf_propertyhandler_getcolor(handler, f, &corners) != LIB3MF_OK) return kNoColor;
    const Color first = color(corners.m_Colors[0]);
    if (first != color(corners.m_Colors[1]) || first != color(corners.m_Colors[2])) warn_once("colours that change within a facet: that of its first corner is taken");
    return first;
  }

  Color default_color(NMR::PLib3MFModelMeshObject* mesh) {
    Handle<NMR::PLib3MFDefaultPropertyHandler> handler;
    ask([&](auto** out) { return NMR::lib3mf_object_createdefaultpropertyhandler(mesh, out); }, handler);
    NMR::eModelPropertyType type = NMR::MODELPROPERTYTYPE_NONE;
    if (NMR::lib3mf_defaultpropertyhandler_getpropertytype(handler.get(), &type) != LIB3MF_OK) return kNoColor;
    DWORD group = 0, index = 0;
    NMR::MODELMESHCOLOR_SRGB c;
    if (type == NMR::MODELPROPERTYTYPE_BASEMATERIALS && NMR::lib3mf_defaultpropertyhandler_getbasematerial(handler.get(), &group, &index) == LIB3MF_OK) return material_color(group, index);
    if (type == NMR::MODELPROPERTYTYPE_COLOR && NMR::lib3mf_defaultpropertyhandler_getcolor(handler.get(), 0, &c) == LIB3MF_OK) return color(c);
    return kNoColor;
  }

  Color material_color(DWORD group, DWORD index) {
    const auto [at, is_new] = materials_.emplace(std::uint64_t{group} << 32 | index, kNoColor);
    if (!is_new) return at->second;
    NMR::PLib3MFModelBaseMaterial* raw = nullptr;
    if (NMR::lib3mf_model_getbasematerialbyid(model_.get(), group, &raw) != LIB3MF_OK || !raw) return kNoColor;
    const Handle<NMR::PLib3MFModelBaseMaterial> material(raw);
    std::array<char, 64> name{};
    ULONG needed = 0;
    if (NMR::lib3mf_basematerial_getnameutf8(raw, index, name.data(), name.size(), &needed) == LIB3MF_OK && name.data() == kUncoloured) return kNoColor;
    BYTE r = 0, g = 0, b = 0, a = 0;
    if (NMR::lib3mf_basematerial_getdisplaycolor(raw, index, &r, &g, &b, &a) == LIB3MF_OK) at->second = color_of(r, g, b, a);
    return at->second;
  }

  void warn_once(const std::string& warning) {
    if (std::find(file_.warnings.begin(), file_.warnings.end(), warning) == file_.warnings.end()) file_.warnings.push_back(warning);
  }

  // `name`: for parts that have none of their own.
  void place(std::uint32_t id, const Transform& transform, const std::string& name) {
    const Object& object = objects_.at(id);
    const std::string& own = object.name.empty() ? name : object.name;
    if (object.is_mesh) return place_mesh(object.mesh, transform, own);
    for (const Component& c : object.components) place(c.object, transform * c.transform, own);
  }

  void place_mesh(const Mesh& mesh, const Transform& transform, const std::string& name) {
    TriangleSoup& soup = file_.soup;
    if (mesh.facets.empty()) return;
    require_room_for_object(source_, soup.points.size() + mesh.points.size(), soup.facets.size() + mesh.facets.size());
    const auto first = static_cast<std::uint32_t>(soup.points.size());
    for (const Vec3& p : mesh.points) {
      soup.points.push_back(transform(p));
      if (!is_finite(soup.points.back())) source_.fail("places points at coordinates that are not finite", kHint);
    }
    const bool turn = transform.mirrors();
    soup.groups.push_back({name, static_cast<std::uint32_t>(soup.facets.size()), static_cast<std::uint32_t>(mesh.facets.size())});
    for (const Facet& f : mesh.facets) soup.facets.push_back({f[0] + first, f[turn ? 2 : 1] + first, f[turn ? 1 : 2] + first});
    if (!mesh.colors.empty()) soup.colors.resize(soup.facets.size() - mesh.facets.size(), kNoColor), soup.colors.insert(soup.colors.end(), mesh.colors.begin(), mesh.colors.end());
  }

  void finish() {
    TriangleSoup& soup = file_.soup;
    if (!soup.colors.empty()) soup.colors.resize(soup.facets.size(), kNoColor);
    if (soup.groups.size() == 1 && soup.groups[0].name.empty()) soup.groups.clear();
  }

  const Source& source_;
  Handle<NMR::PLib3MFModel> model_;
  MeshFile file_;
  std::unordered_map<std::uint32_t, Object> objects_;
  std::unordered_map<std::uint64_t, Color> materials_;
  std::set<std::string> left_out_;
  std::size_t distinct_ = 0, instanced_ = 0;  // facets
};

bool is_model(const ZipEntry& entry) { return entry.name.size() > 6 && entry.name.ends_with(".model"); }

}  // namespace

void require_3mf(const std::string&, ErrorCode) {}

MeshFile read_3mf(const Source& source) {
  const std::vector<ZipEntry> entries = zip_entries(source);
  if (std::none_of(entries.begin(), entries.end(), is_model))
    source.fail("is a ZIP archive, and no 3MF: there is no file '.model' in it", "unpack it, and give the model that is in it");
  std::unordered_map<std::string, ComponentCounter> models;  // of one file each
  const auto see = [&](const ZipEntry& entry, std::string_view piece) {
    if (is_model(entry)) models[entry.name].put(piece);
  };
  require_harmless(source, entries, std::min(std::max(kAlwaysAllowed, kLargestRatio * source.bytes.size()), kNeverAllowed), see);
  for (const auto& [name, counter] : models)
    if (counter.most_placements() > kMostPlaced) source.fail(fmt::format("places more than {} objects: components refer to each other too often", kMostPlaced), kHint);
  return Reader(source).read();
}

}  // namespace burnish
