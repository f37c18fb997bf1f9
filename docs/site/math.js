// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// pymdownx.arithmatex leaves \( ... \) and \[ ... \] in elements of class arithmatex.
document.addEventListener("DOMContentLoaded", () => {
  for (const formula of document.querySelectorAll(".arithmatex")) {
    const text = formula.textContent.trim();
    katex.render(text.slice(2, -2), formula, {displayMode: text.startsWith("\\["), throwOnError: false});
  }
});
