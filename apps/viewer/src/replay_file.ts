// SPDX-FileCopyrightText: The pcavr authors
// SPDX-License-Identifier: Apache-2.0

// The page of a replay in one file, which has no server.
import { carryFiles } from './page_files';
import { Session } from './session/session';
import { start } from './start';
import { byId } from './ui/dom';

carryFiles(byId('carried-files', HTMLScriptElement).text);
byId('connection', HTMLSpanElement).hidden = true;
void start(() => new Session(null));
