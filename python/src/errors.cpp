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

}  // namespace

std::string with_keywords(const std::string& text) {
  static const std::regex kSetting("`[a-z][a-z0-9]*(?:-[a-z0-9]+)*`");
  std::string words = text;
  for (std::sregex_iterator found(text.begin(), text.end(), kSetting), end; found != end; ++found) {
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
