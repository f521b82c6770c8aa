#pragma once

#include <cstdint>
#include <fstream>
#include <map>
#include <rclcpp/parameter.hpp>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

/// Parameters of a node from a ROS parameter file. Supported YAML: maps by indentation, lists in brackets, numbers,
/// booleans and words.
class ParameterFile {
 public:
  static std::map<std::string, rclcpp::ParameterValue> read(const std::string& file, const std::string& node) {
    std::ifstream lines(file);
    if (!lines) throw std::runtime_error("there is no " + file);
    std::map<std::string, rclcpp::ParameterValue> parameters;
    std::vector<std::pair<std::size_t, std::string>> path;  // Indentation and name.
    for (std::string line; std::getline(lines, line);) {
      line = line.substr(0, line.find('#'));
      const std::size_t indent = line.find_first_not_of(' ');
      const std::size_t colon = line.find(':');
      if (indent == std::string::npos || colon == std::string::npos) continue;
      while (!path.empty() && path.back().first >= indent) path.pop_back();
      path.emplace_back(indent, line.substr(indent, colon - indent));
      std::string value = trimmed(line.substr(colon + 1));
      for (std::string more; !value.empty() && value[0] == '[' && value.back() != ']';) {
        if (!std::getline(lines, more)) throw std::runtime_error("a list of " + file + " has no end");
        value += trimmed(more);
      }
      if (value.empty() || path.size() < 3 || path[0].second != node) continue;
      std::string name;
      for (std::size_t i = 2; i < path.size(); ++i) name += (i > 2 ? "." : "") + path[i].second;
      parameters[name] = value_of(value);
    }
    return parameters;
  }

 private:
  static std::string trimmed(const std::string& text) {
    const std::size_t first = text.find_first_not_of(" \r");
    return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \r") + 1 - first);
  }
  static bool is_number(const std::string& text) {
    return text.find_first_not_of("+-.0123456789e") == std::string::npos;
  }
  static rclcpp::ParameterValue value_of(const std::string& text) {
    if (text[0] == '[') return list_of(text.substr(1, text.size() - 2));
    if (text == "true" || text == "false") return rclcpp::ParameterValue(text == "true");
    if (!is_number(text)) return rclcpp::ParameterValue(text);
    if (text.find('.') == std::string::npos) return rclcpp::ParameterValue(std::int64_t{std::stoll(text)});
    return rclcpp::ParameterValue(std::stod(text));
  }
  static rclcpp::ParameterValue list_of(const std::string& text) {
    std::vector<std::string> words;
    std::istringstream parts(text);
    for (std::string part; std::getline(parts, part, ',');) words.push_back(trimmed(part));
    if (words.empty() || !is_number(words[0])) return rclcpp::ParameterValue(words);
    std::vector<double> numbers;
    for (const std::string& word : words) numbers.push_back(std::stod(word));
    return rclcpp::ParameterValue(numbers);
  }
};
