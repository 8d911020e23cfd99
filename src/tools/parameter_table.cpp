#include <cctype>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <stdexcept>

#include <CLI/CLI.hpp>

#include "rgbd_recognition/recognizer.h"

namespace recognition {
namespace {

using Group = std::pair<std::string, ParameterList>;

std::string number(double value) {
  std::ostringstream text;
  text << std::setprecision(15) << value;
  return text.str();
}

std::string allowed(const Parameter& p) {
  if (std::holds_alternative<bool*>(p.value)) return "true, false";
  if (!std::holds_alternative<ChoiceAccess>(p.value)) return number(p.min) + " to " + number(p.max);
  std::string text;
  for (const std::string& choice : p.choices) text += (text.empty() ? "" : ", ") + choice;
  return text;
}

/// Why a default is what it is.
struct Origin {
  const char* group;
  const char* name;
  bool everyday;  ///< stands in config/default.yaml
  const char* chosen_on;
};

constexpr Origin kOrigins[] = {
#include "tools/parameter_origins.inc"
};

const Origin& originOf(const std::string& group, const std::string& name) {
  for (const Origin& origin : kOrigins)
    if (group == origin.group && name == origin.name) return origin;
  throw std::runtime_error("src/tools/parameter_origins.inc does not say what " + group + "/" + name +
                           " was chosen on");
}

/// Throws if an origin is of no parameter.
void checkOrigins(const std::vector<Group>& groups) {
  std::set<std::string> known;
  for (const Group& group : groups)
    for (const Parameter& p : group.second) known.insert(group.first + "/" + p.name);
  for (const Origin& origin : kOrigins)
    if (!known.count(std::string(origin.group) + "/" + origin.name))
      throw std::runtime_error(std::string("src/tools/parameter_origins.inc: ") + origin.group + "/" + origin.name +
                               " is no parameter");
}

void writeMarkdown(const Group& group, std::ostream& out) {
  out << "### " << group.first
      << "\n\n| name | default | unit | allowed | meaning | chosen on |\n| --- | --- | --- | --- | --- | --- |\n";
  for (const Parameter& p : group.second) {
    const Origin& origin = originOf(group.first, p.name);
    const std::string name = "`" + p.name + "`";
    out << "| " << (origin.everyday ? "**" + name + "**" : name) << " | " << valueText(p) << " | " << p.unit << " | "
        << allowed(p) << " | " << p.doc << " | " << origin.chosen_on << " |\n";
  }
  out << "\n";
}

/// One line a parameter: value, unit, range, and of the advanced ones what it was chosen on.
void writeYamlLine(const Parameter& p, const Origin& origin, std::ostream& out) {
  out << "  " << p.name << ": " << valueText(p) << "  # " << (p.unit.empty() ? "" : p.unit + "; ") << allowed(p) << "; "
      << (origin.everyday ? p.doc : origin.chosen_on) << "\n";
}

void writeYaml(const Group& group, bool everyday, std::ostream& out) {
  std::ostringstream lines;
  for (const Parameter& p : group.second)
    if (const Origin& origin = originOf(group.first, p.name); origin.everyday == everyday)
      writeYamlLine(p, origin, lines);
  if (!lines.str().empty()) out << group.first << ":\n" << lines.str();
}

/// A string of the .cfg, in which dynamic_reconfigure allows no quotes.
std::string quoted(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '\'' || c == '"' ? std::string("\u2019") : std::string(1, c);
  return '"' + out + '"';
}

/// segmentation -> Segmentation, feature_extraction -> FeatureExtraction.
std::string camelCase(const std::string& name) {
  std::string out;
  bool upper = true;
  for (const char c : name) {
    if (c != '_') out += upper ? static_cast<char>(std::toupper(c)) : c;
    upper = c == '_';
  }
  return out;
}

void writeCfgLine(const Parameter& p, std::ostream& out) {
  const std::string doc = quoted(p.doc + (p.unit.empty() ? "" : " [" + p.unit + "]"));
  const std::string head = "gen.add(" + quoted(p.name) + ", ";
  const std::string range = ", " + number(p.min) + ", " + number(p.max) + ")\n";
  if (const auto* b = std::get_if<bool*>(&p.value)) {
    out << head << "bool_t, 0, " << doc << ", " << (**b ? "True" : "False") << ")\n";
  } else if (const auto* i = std::get_if<int*>(&p.value)) {
    out << head << "int_t, 0, " << doc << ", " << **i << range;
  } else if (const auto* d = std::get_if<double*>(&p.value)) {
    out << head << "double_t, 0, " << doc << ", " << number(**d) << range;
  } else {
    out << p.name << " = gen.enum([\n";
    for (const std::string& choice : p.choices)
      out << "  gen.const(" << quoted(p.name + "_" + choice) << ", str_t, " << quoted(choice) << ", \"\"),\n";
    out << "], " << doc << ")\n"
        << head << "str_t, 0, " << doc << ", " << quoted(valueText(p)) << ", edit_method=" << p.name << ")\n";
  }
}

void writeCfg(const Group& group, std::ostream& out) {
  out << "#!/usr/bin/env python3\n"
         "# Written by parameter_table --update from the core's own list, which holds the defaults; a test compares "
         "them.\n"
         "from dynamic_reconfigure.parameter_generator_catkin import *\n\n"
         "gen = ParameterGenerator()\n";
  for (const Parameter& p : group.second) writeCfgLine(p, out);
  out << "\nexit(gen.generate(\"rgbd_recognition\", \"rgbd_recognition\", " << quoted(camelCase(group.first)) << "))\n";
}

/// Every parameter of the group in the order of its list, as a file of one's own may have it.
std::string completeYaml(const Group& group) {
  std::ostringstream out;
  out << group.first << ":\n";
  for (const Parameter& p : group.second) writeYamlLine(p, originOf(group.first, p.name), out);
  return out.str();
}

constexpr char kPageHead[] =
    "# Parameters\n\nOf each stage, as `config/*.yaml`, the nodelets' private namespaces and dynamic_reconfigure have "
    "them. Written by `parameter_table --update .` from the core's own lists, which hold the defaults; a test compares "
    "them. `config/default.yaml` has the bold ones, `config/advanced.yaml` the rest. What the nodelets read beside "
    "these stands in [messages.md](messages.md#parameters-beside-the-stages).\n\n";

constexpr char kDefaultHead[] =
    "# What a user may want to change; the rest stands in advanced.yaml. Launch files load both, this one last, and "
    "any\n"
    "# file given as config:= in its place. Written by parameter_table --update.\n";

constexpr char kAdvancedHead[] =
    "# All other parameters: default, unit, allowed values, what the default was chosen on. doc/parameters.md says "
    "what\n"
    "# each means. Written by parameter_table --update.\n";

/// The package's files that are made of the parameters, by name inside the package.
std::map<std::string, std::string> filesMadeOf(const std::vector<Group>& groups) {
  std::map<std::string, std::string> files;
  checkOrigins(groups);
  std::ostringstream everyday, advanced, page;
  everyday << kDefaultHead;
  advanced << kAdvancedHead;
  page << kPageHead;
  for (const Group& group : groups) {
    std::ostringstream cfg;
    writeCfg(group, cfg);
    files["cfg/" + camelCase(group.first) + ".cfg"] = cfg.str();
    writeYaml(group, true, everyday);
    writeYaml(group, false, advanced);
    writeMarkdown(group, page);
  }
  files["config/default.yaml"] = everyday.str();
  files["config/advanced.yaml"] = advanced.str();
  files["doc/parameters.md"] = page.str().substr(0, page.str().size() - 1);  // no empty line at the end
  return files;
}

void updateFiles(const std::vector<Group>& groups, const std::string& package) {
  for (const auto& [name, text] : filesMadeOf(groups)) {
    std::ofstream out(package + "/" + name);
    out << text;
    if (!out.flush()) throw std::runtime_error(package + "/" + name + " cannot be written");
  }
}

void checkFiles(const std::vector<Group>& groups, const std::string& package) {
  for (const auto& [name, text] : filesMadeOf(groups)) {
    std::ifstream in(package + "/" + name);
    if (std::string(std::istreambuf_iterator<char>(in), {}) != text)
      throw std::runtime_error(name + " is not what the parameters make of it: run parameter_table --update " +
                               package);
  }
}

}  // namespace
}  // namespace recognition

int main(int argc, char** argv) {
  using namespace recognition;
  CLI::App app("Prints all parameters of the pipeline with default, unit, range and meaning.");
  std::string format = "markdown", package, checked;
  app.add_option("--format", format, "markdown or yaml")->check(CLI::IsMember({"markdown", "yaml"}));
  app.add_option("--update", package, "write the files of the package in this folder that are made of them instead")
      ->check(CLI::ExistingDirectory);
  app.add_option("--check", checked, "compare those files instead")->check(CLI::ExistingDirectory);
  CLI11_PARSE(app, argc, argv);
  try {
    RecognizerParameters parameters;
    const auto groups = parameters.groups();
    if (!package.empty()) {
      updateFiles(groups, package);
      return 0;
    }
    if (!checked.empty()) {
      checkFiles(groups, checked);
      return 0;
    }
    for (const auto& group : groups) {
      if (format == "markdown") writeMarkdown(group, std::cout);
      if (format == "yaml") std::cout << completeYaml(group);
    }
  } catch (const std::exception& error) {
    std::cerr << "parameter_table: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
