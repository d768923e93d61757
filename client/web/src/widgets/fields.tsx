// Parts of forms: each says beside itself what the daemon has against it.
import type { ComponentChildren } from "preact";
import { useId, useState } from "preact/hooks";
import { complaintOf, useFieldOfForm } from "./complaints";

export function Complaint({ field, id }: { field?: string; id?: string }) {
  useFieldOfForm(field);
  const text = complaintOf(field);
  return text === "" ? null : (
    <p class="complaint" id={id} role="alert">
      {text}
    </p>
  );
}

interface NumberProps {
  label: string;
  unit?: string;
  value: number | undefined;
  /** path in the plan, for violations */
  field?: string;
  step?: number;
  min?: number;
  max?: number;
  placeholder?: string;
  onChange: (value: number | undefined) => void;
}

export function NumberField({ label, unit, value, field, step, min, max, placeholder, onChange }: NumberProps) {
  const id = useId();
  // What is being typed stays while the page around it is drawn again.
  const [typed, setTyped] = useState<string | undefined>(undefined);
  const wrong = complaintOf(field) !== "";
  return (
    <div class="field">
      <label for={id}>{label}</label>
      <span class="with-unit">
        <input
          id={id}
          type="number"
          value={typed ?? value ?? ""}
          step={step ?? "any"}
          min={min}
          max={max}
          placeholder={placeholder}
          data-typing={typed === undefined ? undefined : ""}
          aria-invalid={wrong}
          aria-describedby={wrong ? `${id}-complaint` : undefined}
          onInput={(event) => setTyped(event.currentTarget.value)}
          onBlur={() => setTyped(undefined)}
          onChange={(event) => {
            setTyped(undefined);
            onChange(event.currentTarget.value === "" ? undefined : Number(event.currentTarget.value));
          }}
        />
        {unit && <span class="unit">{unit}</span>}
      </span>
      <Complaint field={field} id={`${id}-complaint`} />
    </div>
  );
}

export function TextField({
  label,
  value,
  field,
  onChange,
}: {
  label: string;
  value: string;
  field?: string;
  onChange: (value: string) => void;
}) {
  const id = useId();
  const [typed, setTyped] = useState<string | undefined>(undefined);
  return (
    <div class="field">
      <label for={id}>{label}</label>
      <input
        id={id}
        type="text"
        value={typed ?? value}
        maxLength={63}
        data-typing={typed === undefined ? undefined : ""}
        onInput={(event) => setTyped(event.currentTarget.value)}
        onBlur={() => setTyped(undefined)}
        onChange={(event) => {
          setTyped(undefined);
          onChange(event.currentTarget.value.trim());
        }}
      />
      <Complaint field={field} />
    </div>
  );
}

interface SelectProps {
  label: string;
  value: string | number;
  options: { value: string | number; label: string }[];
  field?: string;
  onChange: (value: string) => void;
}

export function SelectField({ label, value, options, field, onChange }: SelectProps) {
  const id = useId();
  return (
    <div class="field">
      <label for={id}>{label}</label>
      <select id={id} value={value} onChange={(event) => onChange(event.currentTarget.value)}>
        {options.map((option) => (
          <option value={option.value} key={option.value}>
            {option.label}
          </option>
        ))}
      </select>
      <Complaint field={field} />
    </div>
  );
}

export function CheckField({
  label,
  value,
  onChange,
}: {
  label: string;
  value: boolean;
  onChange: (value: boolean) => void;
}) {
  return (
    <label class="check">
      <input type="checkbox" checked={value} onChange={(event) => onChange(event.currentTarget.checked)} />
      {label}
    </label>
  );
}

export function FileButton({
  label,
  accept,
  folder,
  onFiles,
}: {
  label: string;
  accept?: string;
  folder?: boolean;
  onFiles: (files: File[]) => void | Promise<void>;
}) {
  return (
    <label class="button">
      {label}
      <input
        type="file"
        class="hidden-input"
        accept={accept}
        aria-label={label}
        {...(folder ? { webkitdirectory: true } : {})}
        onChange={(event) => {
          const files = Array.from(event.currentTarget.files ?? []);
          event.currentTarget.value = "";
          if (files.length > 0) void onFiles(files);
        }}
      />
    </label>
  );
}

export function Section({
  title,
  children,
  aside,
}: {
  title: string;
  children: ComponentChildren;
  aside?: ComponentChildren;
}) {
  return (
    <section class="section">
      <header>
        <h3>{title}</h3>
        {aside}
      </header>
      {children}
    </section>
  );
}

export function Segmented<T extends string>({
  label,
  value,
  options,
  onChange,
}: {
  label: string;
  value: T;
  options: { value: T; label: string }[];
  onChange: (value: T) => void;
}) {
  return (
    <div class="segmented" role="radiogroup" aria-label={label}>
      {options.map((option, index) => (
        <button
          type="button"
          role="radio"
          key={option.value}
          aria-checked={option.value === value}
          tabIndex={option.value === value ? 0 : -1}
          onClick={() => onChange(option.value)}
          onKeyDown={(event) => {
            const by = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
            if (by === undefined) return;
            event.preventDefault();
            event.stopPropagation();
            const next = (index + by + options.length) % options.length;
            onChange(options[next].value);
            (event.currentTarget.parentElement!.children[next] as HTMLElement).focus();
          }}
        >
          {option.label}
        </button>
      ))}
    </div>
  );
}
