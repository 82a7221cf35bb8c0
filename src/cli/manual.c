// The manual page and the shell's completion, made from the tables of commands and options.
#include "command.h"
#include "layout.h"

#include <stdio.h>
#include <string.h>

// Text as troff takes it: a hyphen that is typed, and no line that begins with a dot.
static void print_troff(const char *text) {
    for (; *text; text++)
        if (*text == '-')
            printf("\\-");
        else if (*text == '\\')
            printf("\\e");
        else
            putchar(*text);
}

static void print_option(const ck_OptionText *option) {
    printf(".TP\n\\fB");
    if (option->letter) printf("\\-%c\\fR, \\fB", option->letter);
    printf("\\-\\-");
    print_troff(option->name);
    printf("\\fR");
    if (option->value) {
        printf(" \\fI");
        print_troff(option->value);
        printf("\\fR");
    }
    printf("\n");
    print_troff(option->help);
    if (*option->fallback) printf(" (default: ");
    print_troff(option->fallback);
    printf(*option->fallback ? ")\n" : "\n");
}

void ck_manual_print(const ck_Command *const *commands, int count) {
    printf(".TH CLOTHCHECK 1 \"\" \"clothcheck " CK_VERSION "\"\n.SH NAME\nclothcheck \\- compares cloth solvers with "
           "ground truth and each other\n.SH SYNOPSIS\n.B clothcheck\n.I COMMAND\n[\\fIoptions\\fR]\n.SH DESCRIPTION\n"
           "Which cloth solver, at which settings, gives the right sag, stretch and motion for a scene, and what does "
           "it cost?\n.SH COMMANDS\n");
    for (int i = 0; i < count; i++) {
        const ck_Command *command = commands[i];
        ck_OptionText option;
        printf(".SS clothcheck ");
        print_troff(command->name);
        printf(" %s\n", command->arguments);
        print_troff(command->help);
        printf("\n");
        for (int k = 0; (option = ck_option_text(command, k)).name; k++) print_option(&option);
    }
    printf(".SH EXIT STATUS\n0 fine, 1 a check failed, 2 wrong usage or input.\n");
}

void ck_completion_print(const ck_Command *const *commands, int count) {
    printf("# bash completion of clothcheck\n_clothcheck() {\n\tlocal word=${COMP_WORDS[COMP_CWORD]} "
           "command=${COMP_WORDS[1]} before=${COMP_WORDS[COMP_CWORD-1]} words=\n\tif [ \"$COMP_CWORD\" -eq 1 ]; then "
           "words='help");
    for (int i = 0; i < count; i++) printf(" %s", commands[i]->name);
    printf("'\n\telif [ \"$before\" = --engine ] || [ \"$before\" = -e ] || [ \"$before\" = --like ]; then words='");
    for (int i = 0; i < ck_engine_count(); i++) printf("%s%s", i ? " " : "", ck_engine_at(i)->name);
    printf("'\n\telse\n\t\tcase $command in\n");
    for (int i = 0; i < count; i++) {
        ck_OptionText option;
        printf("\t\t%s) words='--help", commands[i]->name);
        for (int k = 0; (option = ck_option_text(commands[i], k)).name; k++) printf(" --%s", option.name);
        printf("' ;;\n");
    }
    printf("\t\tesac\n\tfi\n\tCOMPREPLY=($(compgen -W \"$words\" -- \"$word\") $(compgen -f -- \"$word\"))\n}\n"
           "complete -o filenames -F _clothcheck clothcheck\n");
}

void ck_columns_print(void) {
    printf("| file | what it holds | columns |\n|---|---|---|\n");
    for (int i = 0; i < CK_LAYOUT_COUNT; i++) {
        printf("| `%s` | %s | ", ck_layouts[i].file, ck_layouts[i].about);
        for (int k = 0; ck_layouts[i].columns[k].name; k++)
            printf("%s%s", k ? ", " : "", ck_layouts[i].columns[k].name);
        printf(" |\n");
    }
}

void ck_commands_print(const ck_Command *const *commands, int count) {
    printf("| command | what it does |\n|---|---|\n");
    for (int i = 0; i < count; i++)
        printf("| `clothcheck %s%s%s` | %s |\n", commands[i]->name, *commands[i]->arguments ? " " : "",
               commands[i]->arguments, commands[i]->about);
}
