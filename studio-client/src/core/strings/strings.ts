// Strings by key, each in English and in Chinese.

export type Strings = Record<string, readonly [string, string]>;
