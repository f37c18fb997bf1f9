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

/// Units, uncertainties and the limiting friction's symbol as print has them: "N/m^(n+1)" as
/// "N/mⁿ⁺¹", " +- " as " ± ". Other text stays: only a power of m is a unit here.
export function typeset(text: string): string {
  return text
    .replace(/\bm\^(?:\(([n\d.+-]+)\)|([n\d][\d.]*))/g, (_, inside?: string, plain?: string) => {
      const power = inside ?? plain ?? '';
      return 'm' + [...power].map((character) => raised[character]).join('');
    })
    .replace(/\bF_M\b/g, 'Fₘ')
    .replace(/ \+- ?/g, ' ± ');
}

/// Shown text: "2.77e+05" as "2.77·10⁵", and no line ends inside "N s" or between a number and its
/// unit.
export function printed(text: string): string {
  return text
    .replace(/(\d)e([+-]\d+)\b/g, (_, digit: string, power: string) => {
      const exponent = [...String(Number(power))].map((character) => raised[character]).join('');
      return `${digit}·10${exponent}`;
    })
    .replace(/\bN s\b/g, `N${noBreak}s`)
    .replace(/(\d) (?=(?:%|mm|ms|m|s|deg|kg|N)(?!\w))/g, `$1${noBreak}`);
}
