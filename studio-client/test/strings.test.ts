import { expect, test } from "vitest";
import { ALL_KEYS, inLanguages, setLanguage, t, term } from "../src/core/strings";
import { FIELDS } from "../src/core/strings/terms";

test("every string is there in both languages", () => {
  for (const key of ALL_KEYS) {
    const [english, chinese] = inLanguages(key);
    if (key === "unitNone") continue;
    expect(english, key).not.toBe("");
    expect(chinese, key).not.toBe("");
    expect(english, key).not.toMatch(/[\u4e00-\u9fff](?!.*Language)/);
  }
  setLanguage("zh-CN");
  expect(t("export")).toBe("导出");
  setLanguage("en");
  expect(t("export")).toBe("Export");
});

test("no string is left over", () => {
  const files = import.meta.glob<string>("../src/**/*.ts", { query: "?raw", import: "default", eager: true });
  const sources = Object.entries(files)
    .filter(([name]) => !name.endsWith("strings.ts"))
    .map(([, text]) => text)
    .join("\n");
  const made = ["did_", "quantity_", "unit", "profile_", "kind_", "handle_", "take_", "field_", "easing_", "coordinates_", "face_", "kernel_", "job_"]; // keys that are put together
  const unused = ALL_KEYS.filter((key) => !made.some((start) => key.startsWith(start)) && !sources.includes(`"${key}"`));
  expect(unused).toEqual([]);
});

test("words of the library have another language where one is known", () => {
  expect(term(FIELDS, "origin")).toBe("origin");
  setLanguage("zh-CN");
  expect(term(FIELDS, "origin")).toBe("原点");
  expect(term(FIELDS, "of_a_new_deformer")).toBe("of a new deformer");
  setLanguage("en");
});
