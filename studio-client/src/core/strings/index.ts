// Every string that the studio says, in each of its languages: one table, made of a part a room.
// A page in another language needs one more column.

import type { Language } from "../settings";
import { AXIAL } from "./axial";
import { CAGE } from "./cage";
import { COMMON } from "./common";
import { FACE } from "./face";
import { KEYS } from "./keys";
import { MODEL } from "./model";
import { EXTENDED } from "./extended";
import { POINTS } from "./points";
import { SITES } from "./sites";
import type { Strings } from "./strings";
import { TIME } from "./time";
import { SURFACE } from "./surface";
import { TOUR } from "./tour";
import { TRANSFER } from "./transfer";

const TABLE = { ...COMMON, ...KEYS, ...FACE, ...MODEL, ...AXIAL, ...CAGE, ...EXTENDED, ...POINTS, ...SITES, ...TIME, ...SURFACE, ...TOUR, ...TRANSFER } as const satisfies Strings;

export type StringKey = keyof typeof TABLE;

let column = 0;

export function setLanguage(language: Language): void {
  column = language === "zh-CN" ? 1 : 0;
}

/** A string of the table, in the language of the page. */
export function t(key: StringKey): string {
  return TABLE[key][column]!;
}

/** A string whose key is made of a prefix and a word; the word itself where the table has none. */
export function tWord(prefix: string, word: string): string {
  const key = `${prefix}${word}`;
  return key in TABLE ? t(key as StringKey) : word;
}

/** A word of the library, in the language of the page where that has one. */
export function term(words: Readonly<Record<string, string>>, word: string, english = word.replaceAll("_", " ")): string {
  return column === 0 ? english : (words[word] ?? english);
}

export const ALL_KEYS = Object.keys(TABLE) as StringKey[];

export function inLanguages(key: StringKey): readonly [string, string] {
  return TABLE[key];
}
