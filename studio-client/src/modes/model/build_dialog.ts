// A model built on the shape from a kernel: which kernel, how far and how much it varies, how many fields.

import { h } from "../../core/dom";
import { t, tWord } from "../../core/strings";
import { numberField, row, segments, select } from "../../panels/controls";
import { openDialog } from "../../panels/dialog";
import type { Studio } from "../../studio";

const KERNELS = ["gaussian", "matern", "exponential", "rational_quadratic", "inverse_multiquadric", "bspline"] as const;

type KernelName = (typeof KERNELS)[number];

export interface KernelChoice {
  sigma: number;
  scale: number;
}

export function buildModel(studio: Studio, { sigma, scale }: KernelChoice): void {
  if (!studio.scene?.mesh) return;
  const choice = { name: "gaussian" as KernelName, sigma, scale, rank: 50, method: "cholesky" as "cholesky" | "nystrom" };
  const text = h("input", { type: "text", class: "search kernel-text", spellcheck: false, "aria-label": t("kernelText") });
  const write = (): void => {
    const width = choice.name === "bspline" ? "support" : "sigma";
    text.value = `${choice.name}(${width}=${short(choice.sigma)}, scale=${short(choice.scale)})`;
  };
  const field = (key: "sigma" | "scale", label: string): HTMLElement =>
    numberField(
      choice[key],
      (value) => {
        choice[key] = value;
        write();
      },
      { label, low: 1e-9, step: choice[key] / 10 },
    );
  write();
  const body = h(
    "div",
    { class: "form" },
    h("p", { class: "muted" }, t("buildModelText")),
    row(
      t("kernel"),
      select(
        KERNELS.map((name) => [name, tWord("kernel_", name)] as const),
        choice.name,
        (name) => {
          choice.name = name;
          write();
        },
        t("kernel"),
      ),
    ),
    row(t("kernelSigma"), field("sigma", t("kernelSigma"))),
    row(t("kernelScale"), field("scale", t("kernelScale"))),
    row(t("kernelText"), text),
    row(t("fields"), numberField(choice.rank, (rank) => (choice.rank = rank), { label: t("fields"), integer: true, low: 1, step: 10 })),
    row(
      t("modelMethod"),
      segments([["cholesky", t("methodCholesky")], ["nystrom", t("methodNystrom")]], choice.method, (method) => (choice.method = method)),
    ),
  );
  openDialog(studio.root, t("buildModel"), body, {
    label: t("buildModelDo"),
    run: async () => {
      const answer = await studio.ask("model.build", { kernel: text.value, rank: choice.rank, method: choice.method });
      return answer !== null;
    },
  });
}

const short = (value: number): string => String(Number(value.toPrecision(4)));
