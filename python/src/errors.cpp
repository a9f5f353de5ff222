// SPDX-License-Identifier: Apache-2.0
#include "errors.hpp"

#include <algorithm>
#include <exception>
#include <regex>

#include "gazetrace/error.hpp"

namespace gazetrace::python {
namespace {

namespace py = pybind11;

const char* kind_name(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::usage:
      return "usage";
    case ErrorKind::input:
      return "input";
    case ErrorKind::runtime:
      return "runtime";
    case ErrorKind::nothing_to_do:
      return "nothing_to_do";
    case ErrorKind::interrupted:
      break;
  }
  return "interrupted";
}

// Whether a place of a message lies in a command of the program, such as gazetrace gaze import log.csv `unit` px: such
// a command takes the program's own options, in Python too.
bool stands_in_command(const std::string& text, std::size_t at) {
  const std::size_t command = text.rfind("gazetrace ", at);
  if (command == std::string::npos) {
    return false;
  }
  const bool is_quoted = command > 0 && text[command - 1] == '\'';
  return text.find_first_of(is_quoted ? "'" : ";)", command) > at;
}

}  // namespace

std::string with_keywords(const std::string& text) {
  static const std::regex kSetting("`[a-z][a-z0-9]*(?:-[a-z0-9]+)*`");
  std::string words = text;
  for (std::sregex_iterator found(text.begin(), text.end(), kSetting), end; found != end; ++found) {
    const std::size_t at = static_cast<std::size_t>(found->position());
    const std::size_t length = static_cast<std::size_t>(found->length());
    if (stands_in_command(text, at)) {
      words.replace(at, length, "--" + found->str().substr(1, length - 2));  // as long as it was
      continue;
    }
    const auto begin = words.begin() + found->position();
    std::replace(begin, begin + found->length(), '-', '_');
  }
  return words;
}

std::vector<std::string> in_keywords(std::vector<std::string> texts) {
  for (std::string& text : texts) {
    text = with_keywords(text);
  }
  return texts;
}

void translate_errors() {
  py::register_local_exception_translator([](std::exception_ptr thrown) {
    if (!thrown) {
      return;
    }
    try {
      std::rethrow_exception(thrown);
    } catch (const Error& error) {
      const py::object type = py::module_::import("gazetrace._errors").attr("Error");
      PyErr_SetObject(type.ptr(), type(with_keywords(error.what()), kind_name(error.kind())).ptr());
    }
  });
}

}  // namespace gazetrace::python
