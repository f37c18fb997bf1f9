// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
// Where lines break. In tables a number keeps its unit beside it, a sentence is not squeezed to a word per line, and a
// long name (of a test, a file) may break after one of its parts, so that it does not push the next column off the
// page. Short names and options stay whole everywhere.
const longestNumber = 16, shortestSentence = 50, longestUnbroken = 24; // characters
document.addEventListener("DOMContentLoaded", () => {
  for (const cell of document.querySelectorAll(".md-typeset td")) {
    const length = cell.textContent.trim().length;
    if (length <= longestNumber) cell.classList.add("pcavr-whole");
    if (length >= shortestSentence) cell.classList.add("pcavr-sentence");
  }
  for (const name of document.querySelectorAll(".md-typeset :is(p, li, td:not(:first-child)) code")) {
    if (name.textContent.length <= longestUnbroken) name.classList.add("pcavr-whole");
    if (name.textContent.length <= longestUnbroken || !name.closest("td")) continue;
    const parts = name.textContent.split(/(?<=[./:,_])|(?<=[a-z0-9])(?=[A-Z])/);
    name.replaceChildren(...parts.flatMap((part) => [part, document.createElement("wbr")]));
  }
});
