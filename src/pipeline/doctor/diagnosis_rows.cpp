// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
#include "diagnosis_rows.hpp"

#include <utility>

namespace pcavr {

DiagnosisRow agreement(std::string what, std::string figure) {
  return {DiagnosisVerdict::agrees, std::move(what), std::move(figure)};
}

DiagnosisRow disagreement(std::string what, std::string figure, std::string cause) {
  return {DiagnosisVerdict::disagrees, std::move(what), std::move(figure), std::move(cause)};
}

DiagnosisRow unchecked(std::string what, std::string reason) {
  return {DiagnosisVerdict::not_checked, std::move(what), std::move(reason)};
}

DiagnosisRow row_of(const Error& error) {
  const Error where{.message = {}, .file = error.file, .line = error.line, .place = error.place};
  std::string what = where.to_string();
  while (what.ends_with(' ') || what.ends_with(':')) what.pop_back();
  return disagreement(what.empty() ? "input" : what, error.message, error.hint);
}

}  // namespace pcavr
