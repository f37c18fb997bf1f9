// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

const raised: Record<string, string> = {
  n: 'ⁿ',
  '+': '⁺',
  '-': '⁻',
  '.': '·',
  ...Object.fromEntries([...'⁰¹²³⁴⁵⁶⁷⁸⁹'].map((digit, i) => [String(i), digit])),
};

const noBreak = '\u00a0';

/// Units and uncertainties as print has them: "N/m^(n+1)" as "N/mⁿ⁺¹", " +- " as " ± ". Other text
/// stays: only a power of m is a unit here.
export function typeset(text: string): string {
  return text
    .replace(/\bm\^(?:\(([n\d.+-]+)\)|([n\d][\d.]*))/g, (_, inside?: string, plain?: string) => {
      const power = inside ?? plain ?? '';
      return 'm' + [...power].map((character) => raised[character]).join('');
    })
    .replace(/ \+- ?/g, ' ± ');
}

/// Shown text whose lines do not end inside "N s" or between a number and its unit.
export function unbroken(text: string): string {
  return text
    .replace(/\bN s\b/g, `N${noBreak}s`)
    .replace(/(\d) (?=(?:%|mm|ms|m|s|deg|kg|N)(?!\w))/g, `$1${noBreak}`);
}
