import { defineConfig } from "vite";

// Two bundles: the page that the server serves, and one module for notebooks, which load nothing else.
export default defineConfig(({ mode }) => ({
  base: "./",
  build: {
    outDir: "../src/pliant/studio/client",
    emptyOutDir: mode !== "widget",
    target: "es2022",
    modulePreload: { polyfill: false },
    assetsInlineLimit: mode === "widget" ? 0 : 4096,
    chunkSizeWarningLimit: 1000,
    ...(mode === "widget"
      ? { lib: { entry: "src/widget.ts", formats: ["es" as const], fileName: () => "widget.js", cssFileName: "widget" } }
      : {}),
  },
}));
