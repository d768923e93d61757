// What eslint checks in the page, its gateway and their tests. Layout is for Prettier, types are for
// tsc; these rules see what neither does.
import js from "@eslint/js";
import hooks from "eslint-plugin-react-hooks";
import ts from "typescript-eslint";

export default ts.config(
  { linterOptions: { reportUnusedDisableDirectives: "error" } },
  js.configs.recommended,
  // Promises that nobody awaits, values that are anything, assertions that say nothing.
  ...ts.configs.recommendedTypeChecked,
  // One way to write what can be written in several.
  ...ts.configs.stylisticTypeChecked,
  { languageOptions: { parserOptions: { project: "./tsconfig.json", tsconfigRootDir: import.meta.dirname } } },
  // Preact's hooks are React's: called in one order, with all that their effects depend on.
  { plugins: { "react-hooks": hooks }, rules: { ...hooks.configs.recommended.rules } },
  // An interface may ask for a promise, or for an iterator of them, where nothing is awaited.
  { rules: { "@typescript-eslint/require-await": "off" } },
  // Tests read JSON whose shape is what they assert.
  {
    files: ["tests/**"],
    rules: { "@typescript-eslint/no-unsafe-assignment": "off", "@typescript-eslint/no-unsafe-member-access": "off" },
  },
);
