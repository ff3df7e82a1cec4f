// volScalarFields: taken apart, changed and written.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "burnish/io/foam_case.h"
#include "foam_file.h"
#include "packed_writer.h"

namespace burnish {
namespace {

std::string_view view(const char* from, const char* to) { return {from, static_cast<std::size_t>(to - from)}; }

// Conditions may name this one's internalField for their value: with a list of the cells' values they could not.
std::string without_macro(std::string text, std::string_view old_value) {
  constexpr std::array<std::string_view, 7> kMacros{"${internalField}", "$internalField", "$:internalField", "$..internalField", "$/internalField", "$!internalField", "$../internalField"};
  if (!old_value.starts_with("uniform")) return text;
  const auto goes_on = [&](std::size_t at) { return at < text.size() && (std::isalnum(static_cast<unsigned char>(text[at])) || text[at] == '_' || text[at] == '.'); };
  for (const std::string_view macro : kMacros)
    for (std::size_t at = text.find(macro); at != text.npos; at = text.find(macro, at + 1))
      if (macro.back() == '}' || !goes_on(at + macro.size())) text.replace(at, macro.size(), old_value);
  return text;
}

// The dictionary boundaryField of a text that ends, or begins, in the middle of a file.
struct Boundary {
  std::string* text = nullptr;
  FoamEntry entry;
  std::vector<FoamEntry> patches;
};

Boundary boundary_of(FoamField& field) {
  for (std::string* text : {&field.after, &field.before}) {
    const Source source{*text, "the field", false, true};
    const std::vector<FoamEntry> entries = foam_entries(source, *text, field.format);
    const FoamEntry* found = find_entry(entries, "boundaryField");
    if (found && found->is_dictionary) return {text, *found, foam_entries(source, found->value, field.format)};
  }
  return {};
}

// Entries of a patch's condition that hold a value of it.
constexpr std::array<std::string_view, 3> kValues{"value", "inletValue", "outletValue"};
// Conditions that take those; any other one computes its value itself, and becomes fixedValue.
constexpr std::array<std::string_view, 5> kTakesValue{"fixedValue", "inletOutlet", "outletInlet", "variableHeightFlowRate", "constantAlphaContactAngle"};

// The body of a patch's condition, with the value.
std::string condition_with(const FoamField& field, const std::string& body, double value) {
  const Source source{body, "the field", false, true};
  const std::string uniform = fmt::format("uniform {}", value);
  const std::vector<FoamEntry> entries = foam_entries(source, body, field.format);
  std::string result;
  const char* copied = body.data();
  const auto replace = [&](std::string_view part, std::string_view by) {
    result.append(view(copied, part.data())).append(by);
    copied = part.data() + part.size();
  };
  for (const FoamEntry& e : entries) {
    if (std::find(kValues.begin(), kValues.end(), e.name) != kValues.end() && !e.is_dictionary) replace(e.value, uniform);
    if (e.name == "type" && std::find(kTakesValue.begin(), kTakesValue.end(), e.value) == kTakesValue.end()) replace(e.value, "fixedValue");
  }
  result.append(view(copied, body.data() + body.size()));
  if (find_entry(entries, "type") && find_entry(entries, "value")) return result;
  result.resize(result.find_last_not_of(" \t\r\n") + 1);
  // Of a type that a macro brings in nothing is known: the later entry counts.
  if (!find_entry(entries, "type")) result += "\n        type            fixedValue;";
  if (!find_entry(entries, "value")) result += fmt::format("\n        value           {};", uniform);
  return result + "\n    ";
}

void put_text(PackedWriter& out, const std::vector<double>& values) {
  for (const double v : values) {
    out.put_number(v);
    out.put("\n");
  }
}

template <class Scalar>
void put_binary(PackedWriter& out, const std::vector<double>& values) {
  for (const double v : values) out.put_raw(static_cast<Scalar>(v));
}

}  // namespace

FoamField read_foam_field(const std::string& path) {
  const FoamFile file(path);
  Source source{file.bytes(), file.path(), false, true};
  const FoamHeader header = foam_header(source, file.compressed());
  if (header.class_name != "volScalarField") source.fail(fmt::format("expected the class volScalarField, found {}", quoted(header.class_name)), "volume fractions are a scalar field of the cells: name another --field");
  const std::vector<FoamEntry> entries = foam_entries(source, view(header.end, source.end()), header.format);
  const FoamEntry* internal = find_entry(entries, "internalField");
  if (!internal || internal->is_dictionary || internal->value.empty()) source.fail("it has no internalField", "take the field from a case that runs, or from its folder 0.orig");
  const FoamEntry* boundary = find_entry(entries, "boundaryField");
  if (!boundary || !boundary->is_dictionary) source.fail("it has no boundaryField", "take the field from a case that runs, or from its folder 0.orig");
  FoamField field;
  field.format = header.format;
  field.before = view(source.begin(), internal->name.data() + internal->name.size());
  const char* behind = internal->value.data() + internal->value.size();
  while (behind < source.end() && static_cast<unsigned char>(*behind) <= ' ') ++behind;
  field.after = view(behind, source.end());
  if (!std::string_view(internal->value).starts_with("nonuniform")) {
    field.after = without_macro(std::move(field.after), internal->value);
    field.before = without_macro(std::move(field.before), internal->value);
  }
  for (const FoamEntry& e : foam_entries(source, boundary->value, header.format)) field.patches.emplace_back(e.name);
  return field;
}

FoamField new_foam_field(const std::string& object, const std::string& dimensions, const std::vector<MeshPatch>& patches, const FoamFormat& format) {
  FoamField field;
  field.format = format;
  field.before = fmt::format("{}\ndimensions      {};\n\ninternalField", foam_header_text("volScalarField", object, format), dimensions);
  field.after = ";\n\nboundaryField\n{\n";
  for (const MeshPatch& p : patches) {
    field.after += fmt::format("    {}\n    {{\n        type            {};\n    }}\n", p.name, is_constraint(p.type) ? p.type : "zeroGradient");
    field.patches.push_back(p.name);
  }
  field.after += "}\n";
  return field;
}

void set_patch_value(FoamField& field, const std::string& patch, const std::vector<MeshPatch>& patches, double value) {
  const auto known = std::find_if(patches.begin(), patches.end(), [&](const MeshPatch& p) { return p.name == patch; });
  if (known == patches.end()) {
    std::string names;
    for (const MeshPatch& p : patches) names += (names.empty() ? "" : ", ") + p.name;
    throw Error(ErrorCode::usage, fmt::format("patch {} is not in the mesh", quoted(patch)), "its patches are " + names);
  }
  if (is_constraint(known->type))
    throw Error(ErrorCode::usage, fmt::format("patch {} is of the type {}, which has no value", patch, known->type), "leave its --patch-value out");
  const Boundary boundary = boundary_of(field);
  if (!boundary.text) throw Error(ErrorCode::unreadable_input, "the field has no boundaryField", "read one that a case holds, or make one by new_foam_field()");
  const auto place = [&](const char* at) { return static_cast<std::size_t>(at - boundary.text->data()); };
  if (const FoamEntry* entry = find_entry(boundary.patches, patch); entry && entry->is_dictionary) {
    boundary.text->replace(place(entry->value.data()), entry->value.size(), condition_with(field, std::string(entry->value), value));
    return;
  }
  // What a pattern or an included file says of it gives way to its own name.
  boundary.text->insert(place(boundary.entry.value.data()) + boundary.entry.value.size(), fmt::format("    {}\n    {{\n        type            fixedValue;\n        value           uniform {};\n    }}\n", patch, value));
  field.patches.push_back(patch);
}

void write_foam_field(OutputFile& file, const FoamField& field, const std::vector<double>& values) {
  PackedWriter sink(file, field.format.compressed);
  sink.put(field.before);
  const bool uniform = !values.empty() && std::all_of(values.begin(), values.end(), [&](double v) { return v == values.front(); });
  if (uniform) {
    sink.put(fmt::format("   uniform {}", values.front()));
  } else {
    sink.put(fmt::format("   nonuniform List<scalar> \n{}\n(", values.size()));
    if (!field.format.binary)
      sink.put("\n"), put_text(sink, values);
    else
      field.format.scalar_bytes == 8 ? put_binary<double>(sink, values) : put_binary<float>(sink, values);
    sink.put(")\n");
  }
  sink.put(field.after);
  sink.finish();
}

}  // namespace burnish
