#!/bin/sh
# A task of a campaign of contact tables. This is the template: edit it, and the next submission uses it. Words in
# double braces are filled in: the settings of the campaign's [slurm] section, and what belongs to the submission.
#SBATCH --job-name={{name}}
{{options}}
#SBATCH --nodes=1
#SBATCH --ntasks=1
#SBATCH --cpus-per-task={{cpus}}
#SBATCH --mem={{memory}}
#SBATCH --time={{time}}
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output={{logs}}/%A_%a.log
# Arrays are no longer than the cluster allows; the argument is the number of tasks in the arrays before.
exec {{program}} campaign task {{folder}} --list {{list}} --task "$((SLURM_ARRAY_TASK_ID + ${1:-0}))" \
  --jobs "${SLURM_CPUS_PER_TASK:-1}"
