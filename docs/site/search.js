// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// A page that is opened as a file may not read the search index: without a server there is no search.
if (location.protocol === "file:") {
  for (const each of document.querySelectorAll("label[for=__search], .md-search")) each.style.display = "none";
}
