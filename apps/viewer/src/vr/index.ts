// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0
import type { App } from '../app';

/// Adds the way into VR to the page.
export function attachVr(_app: App): void {}
